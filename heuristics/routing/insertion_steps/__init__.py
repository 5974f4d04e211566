"""Steps of heuristics that add one site after the other."""
