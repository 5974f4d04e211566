"""Evidence for bounds of selection problems."""

from .... import _guard as _guard
