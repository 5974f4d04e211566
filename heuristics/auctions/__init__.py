"""Auctions, and what else assigns robots to bins and tasks."""

from ... import _guard as _guard
