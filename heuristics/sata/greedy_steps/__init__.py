"""Parts of the heuristics for selection problems: evaluation, compiled loops, guarantees, evidence."""

from .... import _guard as _guard
