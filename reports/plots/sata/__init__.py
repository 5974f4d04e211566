"""Pictures of selections and sensing graphs."""

from .... import _guard as _guard
