"""File formats of auctions and task allocation."""
