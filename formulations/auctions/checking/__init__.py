"""Checkers of evidence on auctions and task allocation, in plain code of their own."""

from .... import _guard as _guard
