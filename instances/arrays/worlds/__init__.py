"""Worlds whose decisions are bare programs."""
