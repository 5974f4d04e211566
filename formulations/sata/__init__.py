"""Bottleneck assignment, max-min programs, submodular selection and winner takes all."""
