"""Routing: problem, routes, objective and judge."""
