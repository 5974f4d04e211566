"""Engines that solve max-min programs."""
