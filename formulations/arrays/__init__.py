"""Bare programs as problems of their own."""
