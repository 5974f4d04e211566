"""Places of relays that keep robots connected."""
