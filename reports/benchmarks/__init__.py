"""Benchmarks that compare with a peer in one run, commands of a checkout: ``python -m waybound.reports.benchmarks.NAME --help``.

They are no part of the wheel, and may use what the tests have (``tests/truth``). Exit code 1 says that a target is missed or an answer is
false, 2 that something they need is not there.
"""

from ... import _guard as _guard
