"""Where relays go that keep robots connected."""

from .... import _guard as _guard
