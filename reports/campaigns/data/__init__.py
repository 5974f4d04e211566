"""Bundled campaigns."""

from .... import _guard as _guard
