"""Readers and writers of mesh files, a package for each format."""
