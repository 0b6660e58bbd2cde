"""Order of vertices and polygons: meshes in another order, and section ORDR."""
