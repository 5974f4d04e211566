"""Instances of auctions and task allocation in waybound's JSON: one module a kind."""

from .... import _guard as _guard
