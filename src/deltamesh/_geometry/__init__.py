"""Positions: their methods, and the search for the fewest bytes.

A method is a value (`deltamesh._methods`) and a module of its name with four functions, two pairs
of mirrors: `quantize` <-> `reconstruct` between positions and integers, `encode` <-> `decode`
between integers and payloads. `methods.GeometryCodec` says what they take and return.
"""
