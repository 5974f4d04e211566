"""Data of bare programs, and of what is written as one."""

from ... import _guard as _guard
