"""Heuristics beside bare programs."""
