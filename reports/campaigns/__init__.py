"""Campaigns: instances x problems x solvers and heuristics x options x seeds, resumable, into one results file."""

from ... import _guard as _guard
