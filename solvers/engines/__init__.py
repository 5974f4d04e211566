"""Engines: a problem in, an answer out. One module each."""
