"""Engines that find routes."""

from .... import _guard as _guard
