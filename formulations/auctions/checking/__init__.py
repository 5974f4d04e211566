"""Checkers of evidence on auctions and task allocation, in plain code of their own."""
