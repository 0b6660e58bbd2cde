"""STL, as text and binary."""
