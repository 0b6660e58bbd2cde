"""Reports of `deltamesh bench` and `deltamesh batch` as pages."""
