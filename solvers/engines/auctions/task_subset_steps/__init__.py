"""Dynamic programs over sets of tasks."""
