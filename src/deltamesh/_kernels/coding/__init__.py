"""Kernels of the entropy coder and its models, one function for both directions."""
