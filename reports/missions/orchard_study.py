"""The command ``python -m waybound.reports.missions.orchard_study``, whose module is in a wing."""

from .auctions.orchard_study import main

if __name__ == "__main__":
    raise SystemExit(main())
