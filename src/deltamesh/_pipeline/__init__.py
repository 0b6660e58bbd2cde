"""Pipelines of encoder and decoder: two walks over the table of sections, and the proof of both.

encode: draft -> for each section, payload and draft -> container -> bytes, decoded as a proof
decode: bytes -> container -> limits -> for each section, content -> digest -> positions -> mesh
"""
