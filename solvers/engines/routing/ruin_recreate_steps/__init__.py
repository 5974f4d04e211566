"""Ruin and recreate: data, state and loops of the search."""
