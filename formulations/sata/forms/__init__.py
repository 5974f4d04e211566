"""Forms of selections and max-min programs."""
