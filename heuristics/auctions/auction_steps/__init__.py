"""Parts of auctions of tasks: bids, paths and consensus."""

from .... import _guard as _guard
