"""Parts of the searches for assignments: auctions and prices."""
