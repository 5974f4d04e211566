"""Routing: sites, travel, fleets, and the files that hold them."""

from ... import _guard as _guard
