"""Bottleneck assignment, max-min programs, submodular selection and winner takes all."""

from ... import _guard as _guard
