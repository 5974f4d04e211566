"""Data of auctions and assignments of robots: costs, tasks, orchards."""

from ... import _guard as _guard
