"""Auctions and other approximations for assigning tasks to robots."""
