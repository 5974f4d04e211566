"""The command ``python -m waybound.reports.missions.information_gathering_study``, whose module is in a wing."""

from .auctions.information_gathering_study import main

if __name__ == "__main__":
    raise SystemExit(main())
