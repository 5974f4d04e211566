"""Engines: a problem in, an answer out. One module each."""

from ... import _guard as _guard
