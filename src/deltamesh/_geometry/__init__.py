"""Positions: what is quantized, how it is coded, and the search for the fewest bytes."""
