"""Plugins of other libraries, which convert their meshes and let them open `.dmesh` files.

`deltamesh.plugins.trimesh` and `deltamesh.plugins.meshio` register the format when they are
imported; PyVista finds `deltamesh.plugins.pyvista` by itself. Each has two functions, such as
`to_trimesh` and `from_trimesh`, between its meshes and `PolyMesh`. Nothing is merged or put into
another order: files are written with `keep_order`, so that arrays computed alongside still fit.
A warning names what a library has no place for; docs/python.md lists it.
"""
