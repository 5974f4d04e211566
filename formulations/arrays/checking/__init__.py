"""Checkers of evidence on bare programs, in plain code of their own."""
