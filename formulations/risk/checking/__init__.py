"""Checkers of evidence on problems under risk, in plain code of their own."""

from .... import _guard as _guard
