"""Worlds of uncertain and risky ways."""
