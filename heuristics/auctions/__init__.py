"""Auctions and other approximations for assigning tasks to robots."""

from ... import _guard as _guard
