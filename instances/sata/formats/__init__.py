"""File formats of sensing graphs."""
