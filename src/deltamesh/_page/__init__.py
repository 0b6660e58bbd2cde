"""Page that shows meshes in a browser: complete in itself, with the files in it.

`src/core/build.py` makes it of `src/web`: the viewer, the decoder and the core as WebAssembly. What
it shows is added here. Nothing in it is fetched from elsewhere.
"""
