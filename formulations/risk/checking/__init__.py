"""Checkers of evidence for problems of risk, in plain code of their own."""

from .... import _guard as _guard
