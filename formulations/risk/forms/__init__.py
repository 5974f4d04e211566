"""Forms of problems under risk."""
