"""Evidence for bounds of routing problems."""
