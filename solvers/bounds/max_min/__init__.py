"""Evidence for bounds of max-min problems."""

from .... import _guard as _guard
