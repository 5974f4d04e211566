"""Places of relays that keep robots connected."""

from .... import _guard as _guard
