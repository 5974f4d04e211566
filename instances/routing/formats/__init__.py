"""File formats of routing instances."""
