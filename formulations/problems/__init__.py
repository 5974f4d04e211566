"""Problem classes by name: each module registers the names it builds."""

from ... import _guard as _guard
