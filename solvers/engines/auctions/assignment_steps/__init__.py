"""Parts of the searches for assignments: auctions, matchings, prices."""

from ..... import _guard as _guard
