"""Engines that assign bins, tasks and jobs."""

from .... import _guard as _guard
