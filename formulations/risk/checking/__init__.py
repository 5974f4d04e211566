"""Checkers of evidence on problems under risk, in plain code of their own."""
