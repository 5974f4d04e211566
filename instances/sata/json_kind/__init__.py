"""Sensing graphs, selections and max-min programs in waybound's JSON, one module a kind."""

from .... import _guard as _guard
