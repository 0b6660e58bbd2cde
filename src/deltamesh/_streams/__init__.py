"""Streams of numbers at elements: columns of integers, labels, and floats to the last bit."""
