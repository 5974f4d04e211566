"""Dynamic programs over sets of tasks."""

from ..... import _guard as _guard
