"""Reports: plots, tables, missions, studies and benchmarks."""

from .. import _guard as _guard
