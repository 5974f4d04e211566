"""Seeded recipes for auctions and task allocation."""
