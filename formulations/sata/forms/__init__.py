"""Forms of selections and max-min programs."""

from .... import _guard as _guard
