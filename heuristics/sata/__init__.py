"""Approximations of submodular selection, winner takes all and max-min programs."""
