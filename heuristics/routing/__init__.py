"""Approximations for routing problems."""
