"""Convex programs that are solved again and again, and what successive tangents make of them."""

from ..... import _guard as _guard
