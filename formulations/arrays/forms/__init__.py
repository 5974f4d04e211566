"""The form of a bare program."""

from .... import _guard as _guard
