"""Forms of problems of auctions and task allocation."""
