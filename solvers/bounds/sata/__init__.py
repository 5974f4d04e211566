"""Bounds on selections and max-min programs."""
