"""Evidence for bounds of routing problems."""

from .... import _guard as _guard
