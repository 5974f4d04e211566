"""What heuristics for selection problems share: evaluation, compiled loops, guarantees, evidence."""

from .... import _guard as _guard
