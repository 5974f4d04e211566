"""Engines that allocate risks and find risky or uncertain paths."""
