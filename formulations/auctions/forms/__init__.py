"""Forms of problems of auctions."""

from .... import _guard as _guard
