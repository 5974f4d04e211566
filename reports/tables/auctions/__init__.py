"""Tables of assignments, tasks and jobs."""

from .... import _guard as _guard
