"""Worlds that vehicles and robots go through."""

from .... import _guard as _guard
