"""``waybound warm``."""

from waybound.formulations.kernels import kernels


def test_loops_are_compiled_once(run) -> None:
    first = run("warm", "subset_kernels.path_through").stdout
    assert "1 loop compiled" in first or "ready before: 1 loop" in first
    assert "ready before: 1 loop, nothing to compile" in run("warm", "subset_kernels.path_through").stdout
    assert all(one.kept() for one in kernels("waybound.solvers.engines.auctions.task_subset_steps.subset_kernels") if "path" in one.title)


def test_a_name_that_no_loop_has_is_an_error(run) -> None:
    made = run("warm", "no-such-loop")
    assert made.exit_code == 2 and "no loop is named like 'no-such-loop'" in made.stderr
