"""Generators of sensing graphs and selections."""
