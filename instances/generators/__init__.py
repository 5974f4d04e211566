"""Seeded generators of instances: each module registers one."""

from ... import _guard as _guard
