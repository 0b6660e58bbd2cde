"""Everything of a mesh but its positions: connectivity, stitching, copies, polygons."""
