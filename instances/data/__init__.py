"""Bundled instances, made by the generators of this package."""
