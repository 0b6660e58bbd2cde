"""The commands of deltamesh, one module per command: its flags, its help, and its steps."""
