"""Correspondence of two meshes, and the differences between them."""
