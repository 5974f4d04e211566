"""Engines that find routes."""
