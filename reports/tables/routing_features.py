"""The command ``python -m waybound.reports.tables.routing_features``, whose module is in a wing."""

from .routing.routing_features import main

if __name__ == "__main__":
    raise SystemExit(main())
