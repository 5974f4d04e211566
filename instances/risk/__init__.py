"""Data of problems under risk."""
