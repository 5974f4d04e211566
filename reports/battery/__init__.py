"""The battery: small programs of every form of every family, with optima by enumeration, for whoever doubts a solver."""

from ... import _guard as _guard
