"""Kernels on meshes, without a coder."""
