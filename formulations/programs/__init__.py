"""Programs: arrays, cones, exactness, reductions and exports."""

from ... import _guard as _guard
