"""Worlds that vehicles and robots go through."""
