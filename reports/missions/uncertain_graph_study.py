"""The command ``python -m waybound.reports.missions.uncertain_graph_study``, whose module is in a wing."""

from __future__ import annotations

import sys

from .risk.uncertain_graph_study import main

if __name__ == "__main__":
    sys.exit(main())
