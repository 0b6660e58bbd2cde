"""Sections of a file, each with the coder of both directions."""
