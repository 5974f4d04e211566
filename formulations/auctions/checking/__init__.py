"""Checkers of evidence on problems of auctions, in plain code of their own."""

from .... import _guard as _guard
