"""Evidence for bounds of auctions and task allocation."""
