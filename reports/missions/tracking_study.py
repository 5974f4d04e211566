"""The command ``python -m waybound.reports.missions.tracking_study``, whose module is in a wing."""

from .sata.tracking_study import main

if __name__ == "__main__":
    raise SystemExit(main())
