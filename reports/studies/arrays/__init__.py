"""Studies of what is written as a bare program."""

from .... import _guard as _guard
