"""Routing: sites, travel, fleets, and the files that hold them."""
