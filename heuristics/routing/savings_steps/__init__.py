"""Steps of the savings heuristic."""
