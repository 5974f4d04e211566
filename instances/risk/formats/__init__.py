"""File formats of instances under risk."""

from .... import _guard as _guard
