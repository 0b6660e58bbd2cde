"""How far meshes are apart, and what they take, ours and those of other codecs."""
