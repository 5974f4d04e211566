"""Checkers of routing evidence, in plain code of their own."""
