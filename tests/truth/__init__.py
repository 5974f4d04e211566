"""Optima of tiny problems by brute force in exact arithmetic, each family once.

``waybound.reports.battery`` has accounts of its own, since users run it without the tests. The two share no code, so that each checks the
other (``tests/reports/battery/test_truth.py``).
"""
