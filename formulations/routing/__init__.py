"""Routing: problem, routes, objective and judge."""

from ... import _guard as _guard
