"""Formats of deltamesh: the `.dmesh` container and the mesh files around it."""
