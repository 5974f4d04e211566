"""Engines that assign bins, tasks and jobs."""
