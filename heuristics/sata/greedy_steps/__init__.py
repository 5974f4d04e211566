"""Parts of the heuristics for selection problems: evaluation, compiled loops, guarantees, evidence."""
