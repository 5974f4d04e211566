"""Checkers: one module per kind of evidence, in plain code of its own. Nothing here imports a form, a bound or a solver."""
