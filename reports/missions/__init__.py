"""Missions: what agents decide in a world that unfolds over time, whichever solver decides it. Each mission is a module of its wing."""

from ... import _guard as _guard
