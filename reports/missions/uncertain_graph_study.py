"""The command ``python -m waybound.reports.missions.uncertain_graph_study``, whose module is in a wing."""

from .risk.uncertain_graph_study import main

if __name__ == "__main__":
    raise SystemExit(main())
