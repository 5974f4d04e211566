"""Convex programs that are solved again and again, and successive tangents."""

from ..... import _guard as _guard
