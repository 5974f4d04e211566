"""Convex programs that are solved again and again, and successive tangents."""
