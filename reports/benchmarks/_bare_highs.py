"""Solves programs with the HiGHS of a folder and nothing else; run by path, so that no other package is met.

``python _bare_highs.py FOLDER PROGRAMS OPTIONS`` prints the version and, a program per line, its status and value.
"""

import json
import sys

folder, programs, options = sys.argv[1:4]
sys.path.insert(0, folder)

import highspy  # noqa: E402
import numpy as np  # noqa: E402

NAMES = ("cost", "lower", "upper", "row_lower", "row_upper", "indptr", "indices", "data", "integer")

given = dict(np.load(programs))
made = highspy.Highs()
print(made.version())
for k in range(int(given["count"])):
    arrays = {name: given[f"{k}/{name}"] for name in NAMES}
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = len(arrays["cost"]), len(arrays["row_lower"])
    lp.col_cost_, lp.col_lower_, lp.col_upper_ = arrays["cost"], arrays["lower"], arrays["upper"]
    lp.row_lower_, lp.row_upper_ = arrays["row_lower"], arrays["row_upper"]
    lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = arrays["indptr"], arrays["indices"], arrays["data"]
    lp.integrality_ = [highspy.HighsVarType.kInteger if whole else highspy.HighsVarType.kContinuous for whole in arrays["integer"]]
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    solver.setOptionValue("threads", 1)
    for name, value in json.loads(options).items():
        solver.setOptionValue(name, value)
    solver.passModel(lp)
    solver.run()
    print(solver.modelStatusToString(solver.getModelStatus()), float(solver.getInfo().objective_function_value), sep="\t")
