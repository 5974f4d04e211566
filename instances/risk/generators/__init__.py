"""Seeded recipes for instances under risk."""
