"""How to go through a graph of uncertain edge costs, vertex by vertex, while costs are observed."""

from .... import _guard as _guard
