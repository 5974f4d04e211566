"""Worlds of robots that watch targets."""
