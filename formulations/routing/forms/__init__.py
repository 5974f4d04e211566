"""Forms of routing problems."""
