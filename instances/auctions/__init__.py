"""Data of auctions and task allocation."""

from ... import _guard as _guard
