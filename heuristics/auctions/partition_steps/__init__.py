"""Local search for balanced partitions."""

from .... import _guard as _guard
