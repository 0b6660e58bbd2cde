"""Metrics of two meshes with the same connectivity."""
