"""Bounds on bare programs."""
