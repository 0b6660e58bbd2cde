"""Benchmarks of codecs: measurements, other codecs, and tables of rates."""
