"""Parts of the searches for assignments: auctions and prices."""

from ..... import _guard as _guard
