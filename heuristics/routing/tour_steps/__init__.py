"""Steps of heuristics that cut a tour into routes."""
