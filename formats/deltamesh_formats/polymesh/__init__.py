"""Mesh of polygons that readers return and writers take, and functions of it."""
