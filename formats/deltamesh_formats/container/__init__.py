"""The `.dmesh` container: its layout, reader and writer, and what can be read without decoding."""
