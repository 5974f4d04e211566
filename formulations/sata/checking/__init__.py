"""Checkers of bounds on selections and max-min programs: they read problem data and evidence, nothing else."""
