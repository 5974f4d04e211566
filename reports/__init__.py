"""What people look at: plots, benchmarks, studies."""

from .. import _guard as _guard
