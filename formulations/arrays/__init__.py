"""Bare programs as problems of their own."""

from ... import _guard as _guard
