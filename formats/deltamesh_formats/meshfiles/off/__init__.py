"""OFF, as text and binary."""
