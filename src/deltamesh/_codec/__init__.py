"""Codec as two functions, `encode` and `decode`, between meshes and bytes."""
