"""Kinds of risk data in waybound's JSON."""

from .... import _guard as _guard
