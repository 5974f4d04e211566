"""The data model, readers and writers by format, generators and bundled instances: pure data, no solver."""

from .. import _guard as _guard
