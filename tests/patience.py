"""How long the tests wait for what must end: a guard against hanging, not a measure of time, whatever else the machine does."""

HANG = 120.0
"""Seconds."""
