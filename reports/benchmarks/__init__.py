"""Benchmarks that compare with a peer in one run: python -m waybound.reports.benchmarks.NAME."""

from ... import _guard as _guard
