"""Text formats of instances of auctions."""

from .... import _guard as _guard
