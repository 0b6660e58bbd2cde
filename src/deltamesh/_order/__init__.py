"""The order of vertices and polygons: a mesh in another order, and section ORDR."""
