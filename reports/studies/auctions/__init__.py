"""Studies of auctions."""

from .... import _guard as _guard
