"""Missions whose decisions are problems of several wings."""

from .... import _guard as _guard
