"""Unit normals, coded relative to the normals of the decoded surface."""
