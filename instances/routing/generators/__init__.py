"""Seeded recipes for routing instances."""
