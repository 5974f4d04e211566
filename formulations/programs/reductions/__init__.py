"""Reductions: programs written otherwise for the solvers that need it, and the way back. See docs/architecture.md#reductions."""
