"""Numbers that belong to the vertices, corners and faces of a mesh (section ATTR)."""
