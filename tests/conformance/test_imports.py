"""Every pair of solver packages in one fresh process, in both orders, and a program solved with each of the two.

Native libraries of the same name can push each other out: highspy 1.15 and OR-Tools 9.15 cannot be imported together.
"""

import importlib.util
import itertools
import subprocess
import sys

import pytest

# Each solves min 2x + 3z, x + z >= 4.5, z whole (9, not 15), or the nearest thing that it can express.
HIGHSPY = """
import highspy, numpy as np
h = highspy.Highs(); h.setOptionValue("output_flag", False)
h.addVars(2, np.zeros(2), np.full(2, np.inf))
h.changeColsCost(2, np.arange(2, dtype=np.int32), np.array([2.0, 3.0]))
h.changeColsIntegrality(1, np.array([1], dtype=np.int32), np.ones(1, dtype=np.uint8))
h.addRows(1, np.array([4.5]), np.array([np.inf]), 2, np.zeros(1, dtype=np.int32), np.arange(2, dtype=np.int32), np.ones(2))
h.run(); assert abs(h.getInfo().objective_function_value - 9) < 1e-6, h.getInfo().objective_function_value
"""
ROUTING = """
from ortools.constraint_solver import pywrapcp
m = pywrapcp.RoutingIndexManager(3, 1, 0); r = pywrapcp.RoutingModel(m)
r.SetArcCostEvaluatorOfAllVehicles(r.RegisterTransitMatrix([[0, 2, 9], [9, 0, 3], [4, 9, 0]]))
assert r.Solve().ObjectiveValue() == 9
"""
CP_SAT = """
from ortools.sat.python import cp_model
m = cp_model.CpModel(); x = m.new_int_var(0, 90, "tenths"); z = m.new_int_var(0, 9, "z")
m.add(x + 10 * z >= 45); m.minimize(2 * x + 30 * z)
s = cp_model.CpSolver(); s.parameters.num_workers = 1
assert s.solve(m) == cp_model.OPTIMAL and s.objective_value == 90, s.objective_value
"""
MATHOPT = """
from ortools.math_opt.python import mathopt
m = mathopt.Model(); x = m.add_variable(lb=0); z = m.add_integer_variable(lb=0)
m.add_linear_constraint(x + z >= 4.5); m.minimize(2 * x + 3 * z)
for kind in (mathopt.SolverType.HIGHS, mathopt.SolverType.GSCIP):
    assert abs(mathopt.solve(m, kind).objective_value() - 9) < 1e-6
"""
PULP = """
import pulp
for solver in ("PULP_CBC_CMD", "HiGHS"):
    m = pulp.LpProblem("m", pulp.LpMinimize)
    x = pulp.LpVariable("x", 0); z = pulp.LpVariable("z", 0, cat="Integer")
    m += 2 * x + 3 * z; m += x + z >= 4.5
    m.solve(pulp.getSolver(solver, msg=False)); assert abs(m.objective.value() - 9) < 1e-6, m.objective.value()
"""
CVXPY = """
import cvxpy
x = cvxpy.Variable(nonneg=True); z = cvxpy.Variable(integer=True)
m = cvxpy.Problem(cvxpy.Minimize(2 * x + 3 * z), [x + z >= 4.5, z >= 0])
assert abs(m.solve(solver="HIGHS") - 9) < 1e-6, m.value
"""
CLARABEL = """
import clarabel, numpy as np, scipy.sparse as sp
s = clarabel.DefaultSettings(); s.verbose = False
a = sp.csc_matrix(np.array([[-1.0, -1.0], [-1.0, 0.0], [0.0, -1.0]]))
b, k = np.array([-4.5, 0, 0]), [clarabel.NonnegativeConeT(3)]
got = clarabel.DefaultSolver(sp.csc_matrix((2, 2)), np.array([2.0, 3.0]), a, b, k, s).solve()
assert abs(got.obj_val - 9) < 1e-5, got.obj_val
"""
SCIP = """
import pyscipopt
m = pyscipopt.Model(); m.hideOutput(); x = m.addVar(lb=0); z = m.addVar(lb=0, vtype="I")
m.addCons(x + z >= 4.5); m.setObjective(2 * x + 3 * z); m.optimize()
assert abs(m.getObjVal() - 9) < 1e-6, m.getObjVal()
"""
PYVRP = """
import pyvrp, numpy as np
d = np.array([[0, 2, 9], [9, 0, 3], [4, 9, 0]])
data = pyvrp.ProblemData([pyvrp.Location(0, 0)] * 3, [pyvrp.Client(1), pyvrp.Client(2)], [pyvrp.Depot(0)], [pyvrp.VehicleType()], [d], [d])
assert pyvrp.solve(data, pyvrp.stop.MaxIterations(20), display=False).cost() == 9
"""
VROOM = """
import vroom
made = vroom.Input(); made.set_durations_matrix("car", [[0, 2, 9], [9, 0, 3], [4, 9, 0]])
made.add_job([vroom.Job(1, 1), vroom.Job(2, 2)]); made.add_vehicle(vroom.Vehicle(1, start=0, end=0))
assert made.solve(exploration_level=1, nb_threads=1).summary.cost == 9
"""
SCIPY = """
import numpy as np
from scipy.optimize import LinearConstraint, milp
got = milp([2, 3], constraints=LinearConstraint(np.ones((1, 2)), 4.5, np.inf), integrality=[0, 1])
assert abs(got.fun - 9) < 1e-6, got.fun
"""
PACKAGES = {
    "highspy": ("import highspy", HIGHSPY),
    "routing": ("from ortools.constraint_solver import pywrapcp", ROUTING),
    "cp_model": ("from ortools.sat.python import cp_model", CP_SAT),
    "mathopt": ("from ortools.math_opt.python import mathopt", MATHOPT),
    "pulp": ("import pulp", PULP),
    "cvxpy": ("import cvxpy", CVXPY),
    "clarabel": ("import clarabel", CLARABEL),
    "pyvrp": ("import pyvrp", PYVRP),
    "scipy": ("import scipy.optimize", SCIPY),
}
EXTRAS = {"pyscipopt": ("import pyscipopt", SCIP), "vroom": ("import vroom", VROOM)}
PACKAGES |= {name: code for name, code in EXTRAS.items() if importlib.util.find_spec(name) is not None}
PAIRS = list(itertools.combinations(PACKAGES, 2))
RISKY = [("highspy", "routing"), ("highspy", "mathopt"), ("cvxpy", "cp_model"), ("pulp", "routing"), ("pyvrp", "highspy")]
RISKY += [("pyscipopt", "mathopt")] if "pyscipopt" in PACKAGES else []  # both bring SCIP


def live_together(*names: str) -> None:
    """Import the packages in this order in a fresh process, and only then solve with each."""
    code = "\n".join(PACKAGES[n][0] for n in names) + "".join(PACKAGES[n][1] for n in names) + "\nprint('sound')"
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout.strip().endswith("sound"), f"{' then '.join(names)}:\n{done.stdout[-500:]}{done.stderr[-2000:]}"


@pytest.mark.slow
def test_all_packages_live_in_one_process() -> None:
    live_together(*PACKAGES)


@pytest.mark.slow
def test_all_packages_live_in_one_process_in_the_other_order() -> None:
    live_together(*reversed(PACKAGES))


@pytest.mark.long
@pytest.mark.parametrize("pair", RISKY, ids="-".join)
def test_pairs_that_have_pushed_each_other_out(pair: tuple[str, str]) -> None:
    live_together(*pair)
    live_together(*reversed(pair))


@pytest.mark.long
@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
def test_every_pair_in_both_orders(pair: tuple[str, str]) -> None:
    live_together(*pair)
    live_together(*reversed(pair))
