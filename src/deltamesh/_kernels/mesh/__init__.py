"""Kernels on meshes that code nothing."""
