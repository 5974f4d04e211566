"""Checkers of routing evidence, in plain code of their own."""

from .... import _guard as _guard
