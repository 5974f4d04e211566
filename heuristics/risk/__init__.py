"""Approximations for problems under risk."""
