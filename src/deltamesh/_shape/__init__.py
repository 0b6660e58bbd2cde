"""Structure of a mesh, everything but its positions, and its sections: CONN, STCH, COPY, POLY."""
