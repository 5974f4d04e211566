"""Backends and engines by name: each module registers itself, and imports its package only when it runs."""
