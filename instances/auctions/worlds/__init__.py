"""Worlds of robots that share tasks."""
