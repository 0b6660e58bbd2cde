"""Mesh files: a table of their formats, and a package with reader and writer for each."""
