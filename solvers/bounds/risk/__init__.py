"""Evidence for bounds of problems under risk."""
