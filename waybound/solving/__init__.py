"""Composition: from a problem and a method to an answer with its evidence."""
