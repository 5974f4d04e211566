"""File formats: each module registers a reader, a writer or both."""

from ... import _guard as _guard
