"""The mesh of polygons that readers make and writers take, and functions of it."""
