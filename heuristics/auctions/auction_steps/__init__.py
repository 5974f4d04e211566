"""Parts of auctions of tasks: bids, paths and consensus."""
