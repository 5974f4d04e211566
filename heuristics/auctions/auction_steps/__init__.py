"""What auctions share: bids, paths, consensus, and what guarantees assume."""

from .... import _guard as _guard
