"""File formats of instances under risk."""
