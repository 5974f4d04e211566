"""Problems of auctions and task allocation."""
