"""Sensing graphs: robots, actions, targets and weights, which several families read."""

from ... import _guard as _guard
