"""Families of assignments, tasks and jobs that the studies draw from."""

from ...... import _guard as _guard
