"""Days in the orchard: rules that choose bins and bring new ones, step by step and as one compiled loop."""

from ..... import _guard as _guard
