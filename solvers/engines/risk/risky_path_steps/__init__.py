"""Steps of searches for risky paths.

A package, so that the registry of engines leaves them alone.
"""
