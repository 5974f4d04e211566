"""Fails the import of a top-level folder by its bare name (`import solvers`): import `waybound.solvers` instead."""
