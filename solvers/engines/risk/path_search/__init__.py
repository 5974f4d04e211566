"""Searches for paths in graphs of uncertain edge costs."""

from ..... import _guard as _guard
