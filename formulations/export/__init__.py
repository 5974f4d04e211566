"""Writers and hand-overs of programs: MPS, LP, HiGHS, PuLP, CVXPY, MathOpt."""

from ... import _guard as _guard
