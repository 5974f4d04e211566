"""Sensing graphs, set functions with constraints, and max-min linear programs, as data."""
