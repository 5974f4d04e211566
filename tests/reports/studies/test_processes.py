import os
import sys
import time

import psutil
import pytest

from waybound.instances.errors import WayboundError
from waybound.reports.studies.processes import spread
from waybound.reports.studies.study import STUDIES


def silent(done, total, what):
    pass


def test_results_come_in_the_order_of_the_tasks():
    done = spread(pow, [(2, k) for k in range(5)], 1, silent, str)
    assert done.results == [1, 2, 4, 8, 16]
    assert not done.interrupted


def test_progress_counts_to_the_end():
    told = []
    spread(pow, [(2, 3), (2, 4)], 1, lambda *what: told.append(what), lambda task: f"2^{task[1]}")
    assert told == [(0, 2, "2^3"), (1, 2, "2^4"), (2, 2, "")]


def test_an_interrupt_keeps_what_was_done():
    def work(k):
        if k == 2:
            raise KeyboardInterrupt
        return k

    done = spread(work, [(k,) for k in range(5)], 1, silent, str)
    assert done.results == [0, 1, None, None, None]
    assert done.interrupted


@pytest.mark.long
def test_processes_bring_the_same_results():
    assert spread(pow, [(2, k) for k in range(6)], 2, silent, str).results == [1, 2, 4, 8, 16, 32]


@pytest.mark.long
def test_processes_do_not_outlive_their_parent(tmp_path):
    code = (
        "import time\nfrom waybound.reports.studies.processes import spread\n"
        "if __name__ == '__main__': spread(time.sleep, [(60,), (60,)], 2, lambda *told: None, str)"
    )
    (tmp_path / "script.py").write_text(code)
    parent = psutil.Popen([sys.executable, str(tmp_path / "script.py")])

    def workers():
        return [p for p in parent.children() if "spawn_main" in " ".join(p.cmdline())]

    while len(workers()) < 2:
        time.sleep(0.05)
    time.sleep(2.0)  # until they are at work
    children = workers()
    parent.kill()
    parent.wait()
    assert not psutil.wait_procs(children, timeout=5)[1]


@pytest.mark.long
def test_a_process_that_dies_is_one_clear_error():
    with pytest.raises(WayboundError, match="ended abruptly"):
        spread(os._exit, [(3,), (3,)], 2, silent, str)


@pytest.mark.long
def test_studies_do_not_depend_on_the_number_of_processes():
    study = STUDIES["greedy-partition"]
    assert study(instances=120, jobs=1).observations == study(instances=120, jobs=2).observations
