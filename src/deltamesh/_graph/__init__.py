"""Structure that follows from faces alone, whatever is coded on them.

Half-edges, neighbours, components, parallelograms, and elements with their neighbours. Everything
here is integers, so that encoder and decoder get the same.
"""
