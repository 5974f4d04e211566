"""The command in a process of its own: exit codes, interrupts, pipes, start."""

import json
import os
import signal
import subprocess
import sys
import threading
import time

import pytest
from patience import HANG

import waybound as wb

COMMAND = [sys.executable, "-m", "waybound"]

pytestmark = pytest.mark.timeout(5 * HANG)


def interrupted_at_first_incumbent(*arguments: str) -> tuple[int, str, float]:
    """Exit code, standard output, and seconds between the interrupt and the end."""
    process = subprocess.Popen([*COMMAND, *arguments, "--log", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    watchdog = threading.Timer(4 * HANG, process.kill)
    watchdog.start()
    try:
        assert process.stderr is not None
        for line in process.stderr:
            if "answer by" in line:
                break
        process.send_signal(signal.SIGINT)
        began = time.perf_counter()
        out, _ = process.communicate()
        return process.returncode, out, time.perf_counter() - began
    finally:
        watchdog.cancel()
        process.kill()


@pytest.mark.parametrize("solver", ["pyvrp", pytest.param("ortools", marks=pytest.mark.slow)])
def test_an_interrupt_prints_the_best_answer_verified_and_is_exit_0(solver):
    code, out, _ = interrupted_at_first_incumbent("solve", "demo-rc50", "--solver", solver, "--time-limit", "60", "--json")
    data = json.loads(out)
    assert (code, data["limit"], data["certificate"]["feasible"]) == (0, "interrupt", True)
    problem = wb.read("demo-rc50")
    assert problem.evaluate(problem.answer_from_json(data["answer"])).values[0] == pytest.approx(data["objective"])


MADE = """
import os, signal, sys, threading, time
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Route, Routes
from waybound.solvers.backend import BACKENDS, Engine, RawResult

NUMBER = getattr(signal, sys.argv.pop(1))
ANSWER = Routes.of([Route((7, 5, 3, 2), 0), Route((4, 1, 6), 0)])

def send(number=NUMBER):
    os.kill(os.getpid(), number)

class Made(Engine):
    name, family, package, modules, summary, features = "made", "routing", "waybound", ("json",), "for tests", frozenset()
    def missing(self, problem):
        return frozenset()
    def run(self, problem, options, control):
        {body}

BACKENDS.names()
BACKENDS.add("made", Made)
{more}
sys.argv = ["waybound", *sys.argv[1:]]
from waybound.cli import main
main()
"""

WAITS = """
        threading.Timer(0.2, send).start()
        while not control.stopped:
            time.sleep(0.01)
        return RawResult("unknown", limit="interrupt")
"""

DEAF = """
        control.publish(ANSWER)
        threading.Timer(0.2, send).start()
        time.sleep(60)
"""

ANSWERS = """
        return RawResult("feasible", answer=ANSWER)
"""

WHILE_JUDGING = """
judge = RoutingProblem.evaluate
def judging(self, answer):
    send()
    time.sleep(0.05)
    return judge(self, answer)
RoutingProblem.evaluate = judging
"""

SOLVE = ("solve", "demo-tiny", "--solver", "made", "--json", "-q")
CODES = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129}


def in_python(code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=2 * HANG)


def made(number: str, body: str, more: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    code = MADE.replace("{body}", body.strip()).replace("{more}", more)
    done = in_python(code, number, *arguments)
    assert "Traceback" not in done.stderr
    return done


@pytest.mark.slow
@pytest.mark.parametrize("number", ["SIGTERM", *(pytest.param(name, marks=pytest.mark.slow) for name in ("SIGINT", "SIGHUP"))])
def test_a_signal_that_leaves_no_answer_has_its_own_exit_code(number):
    done = made(number, WAITS, "", *SOLVE)
    assert done.returncode == CODES[number], done.stderr
    assert json.loads(done.stdout)["answer"] is None


@pytest.mark.slow
@pytest.mark.share(2)
@pytest.mark.parametrize(
    ("number", "body", "more"),
    [("SIGINT", ANSWERS, WHILE_JUDGING), ("SIGTERM", DEAF, ""), pytest.param("SIGHUP", DEAF, "", marks=pytest.mark.slow)],
)
def test_an_answer_is_written_whenever_the_signal_comes(number, body, more, tmp_path):
    began = time.perf_counter()
    done = made(number, body, more, *SOLVE, "--out", str(tmp_path / "a.json"), "--certificate", str(tmp_path / "c.json"))
    assert time.perf_counter() - began < HANG
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["certificate"]["feasible"]
    assert wb.check(wb.read("demo-tiny"), tmp_path / "a.json", tmp_path / "c.json").feasible


FINDING = """
import waybound.solving.bounding as bounding
def waits(problem, seconds, *, control, **given):
    send()
    while not control.stopped:
        time.sleep(0.01)
    return []
bounding.find_bounds = waits
"""

EXPLAINING = """
import waybound.solving.explaining as explaining
def waits(problem, form, end, control):
    send()
    while not control.stopped:
        time.sleep(0.01)
explaining._explain_by_rows = waits
"""


@pytest.mark.parametrize(("number", "command", "more"), [("SIGINT", "bound", FINDING), ("SIGTERM", "explain", EXPLAINING)])
def test_bounding_and_explaining_end_with_the_code_of_the_signal_where_nothing_was_found(number, command, more):
    done = made(number, ANSWERS, more, command, "demo-tiny", "--json")
    assert done.returncode == CODES[number], done.stderr


READING = """
import hashlib
import waybound.api as api
def reads(*given, **named):
    threading.Timer(0.2, send).start()
    {wait}
api.read_source = reads
"""


@pytest.mark.parametrize(
    ("number", "wait"),
    [
        ("SIGHUP", "time.sleep(600)"),
        pytest.param("SIGTERM", "hashlib.pbkdf2_hmac('sha256', b'1', b'2', 2**31 - 1)", marks=pytest.mark.slow),
    ],
)
def test_a_signal_ends_a_command_that_has_nothing_to_lose_though_it_is_in_native_code(number, wait):
    began = time.perf_counter()
    done = made(number, ANSWERS, READING.replace("{wait}", wait), *SOLVE)
    assert time.perf_counter() - began < HANG
    assert done.returncode == CODES[number], done.stderr
    assert done.stdout == ""


def test_what_the_caller_has_ignored_stays_ignored():
    code = (
        "import os, signal, sys, time\nsignal.signal(signal.SIGHUP, signal.SIG_IGN)\nimport waybound.cli.app as face\n"
        "def hang_up(**given): os.kill(os.getpid(), signal.SIGHUP); time.sleep(0.1); sys.exit(7)\nface.app = hang_up\n"
        "import waybound.cli\nwaybound.cli.main()"
    )
    assert in_python(code).returncode == 7


def test_an_interrupt_before_anything_has_begun_is_exit_130_without_a_traceback():
    code = (
        "import os, signal, waybound.cli.app as face\ndef stop(**given): os.kill(os.getpid(), signal.SIGINT)\nface.app = stop\n"
        "import waybound.cli\nwaybound.cli.main()"
    )
    done = in_python(code)
    assert done.returncode == 130
    assert "Traceback" not in done.stderr


def test_an_interrupt_after_the_last_word_does_not_change_the_exit_code():
    code = (
        "import atexit, os, signal, sys\natexit.register(lambda: os.kill(os.getpid(), signal.SIGINT))\n"
        "sys.argv = ['waybound', '--version']\nfrom waybound.cli import main\nmain()"
    )
    done = in_python(code)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_reader_that_hangs_up_causes_no_traceback():
    process = subprocess.Popen([*COMMAND, "instances", "show", "demo-rc50"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    _, told = process.communicate(timeout=2 * HANG)
    assert b"Traceback" not in told
    assert b"internal error" not in told


def loaded(*arguments: str) -> subprocess.CompletedProcess[str]:
    """A command that ends well, and on standard error the packages that it has loaded."""
    code = (
        "import sys\nfrom waybound.cli import main\n"
        f"sys.argv = ['waybound', *{arguments!r}]\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "print(*{m.split('.')[0] for m in sys.modules}, file=sys.stderr)"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)


@pytest.mark.share(2)
@pytest.mark.parametrize("arguments", [("--help",), ("--version",), ("solve", "--help"), ("instances", "--help")])
def test_help_and_version_load_no_solver_no_pandas_and_no_scipy(arguments):
    done = loaded(*arguments)
    assert not set(done.stderr.split()) & {"highspy", "ortools", "pulp", "cvxpy", "pyvrp", "pandas", "scipy", "matplotlib", "numba"}
    assert done.stdout


@pytest.mark.slow
def test_checking_a_certificate_loads_no_solver(tmp_path):
    answer, proof = str(tmp_path / "a.json"), str(tmp_path / "c.json")
    words = ("solve", "demo-tiny", "--iterations", "30", "--bound-time", "1", "-q", "--out", answer, "--certificate", proof)
    solved = subprocess.run([*COMMAND, *words], capture_output=True, text=True)
    assert solved.returncode == 0, solved.stderr
    assert json.loads((tmp_path / "c.json").read_text())["bound"] is not None
    done = loaded("check", "demo-tiny", answer, "--certificate", proof)
    assert not set(done.stderr.split()) & {"highspy", "ortools", "pulp", "cvxpy", "pyvrp"}
    assert "verified" in done.stdout


def test_the_version_is_that_of_the_package():
    done = subprocess.run([*COMMAND, "--version"], capture_output=True, text=True, check=True)
    assert done.stdout == f"waybound {wb.__version__}\n"


def test_bad_input_in_a_process_is_exit_2_with_one_line(tmp_path):
    done = subprocess.run([*COMMAND, "solve", str(tmp_path)], capture_output=True, text=True)
    assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (2, "", 1)


@pytest.mark.slow
def test_standard_output_in_ascii_does_not_break_the_tables():
    environment = {**os.environ, "COLUMNS": "120", "PYTHONIOENCODING": "ascii", "LC_ALL": "C", "PYTHONUTF8": "0"}
    done = subprocess.run([*COMMAND, "solve", "demo-tiny", "--iterations", "20", "-q"], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert "vehicle 1" in done.stdout
