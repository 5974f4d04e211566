"""Data of auctions and task allocation."""
