import os

import pytest

from waybound.reports.battery.cases import Draw, cases
from waybound.reports.battery.examining import Examination, outcome
from waybound.reports.battery.report import examination_table, summary_lines, to_json, write_wrong
from waybound.solvers.backend import Options


@pytest.fixture
def wrong() -> tuple[Draw, Examination]:
    draw = Draw(64, 1, "time-windows", "two-index-mtz")
    bare = Options(extra={"presolve_rule_off": 0})
    (hard,), (easy,) = cases(draw, range(16, 17)), cases(draw, range(3, 4))
    return draw, Examination("highs", "1", (outcome("highs", hard, bare), outcome("highs", easy, bare)))


def test_the_table_counts_by_solver_and_by_kind(wrong):
    _, made = wrong
    (row,) = examination_table([made]).rows
    assert row[:7] == ("highs", "1", "2", "0", "1", "0", "0")
    (row,) = examination_table([made], "kind").rows
    assert row[2:4] == ("time-windows", "2")


def test_a_false_word_is_told_with_the_truth_and_written_as_a_program_that_is_read_back(wrong, tmp_path):
    import highspy

    draw, made = wrong
    files = write_wrong(tmp_path / "new", draw, made)
    (line,) = summary_lines(made, files)
    assert "case 16 (time-windows, two-index-mtz): false infeasible: the program is optimal at" in line
    assert os.fspath(tmp_path) in line
    data = to_json(draw, [made], {"highs": files})
    assert data["solvers"][0]["false_infeasible"] == 1
    assert data["solvers"][0]["told"][0]["file"] == files[16]
    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    model.setOptionValue("presolve", "off")
    model.readModel(files[16])
    model.run()
    assert f"optimal at {model.getInfo().objective_function_value:.12g}" == made.outcomes[0].truth
