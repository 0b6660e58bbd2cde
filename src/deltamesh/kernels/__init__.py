"""The hot loops: numba kernels on flat arrays. They trust their arguments; callers check."""
