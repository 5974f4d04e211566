"""The harness of all benchmarks: options and exit codes, clocks, fresh processes, tables, and the folders of a checkout."""

import argparse
import inspect
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar

from ...formulations.programs.program import Program
from ...instances.generating import generate
from ...solvers.backend import Control, Options, RawResult, solver_named
from ...solvers.program_backend import ProgramBackend

T = TypeVar("T")


def find_tests() -> None:
    """Put the folder ``tests`` of this checkout on the path, for its exact truths; ends with exit code 2 where there is none."""
    tests = Path(__file__).resolve().parents[2] / "tests"
    if not (tests / "truth").is_dir():
        print(f"error: the exact truths to compare with are not there: {tests / 'truth'}; run this from a checkout", file=sys.stderr)
        raise SystemExit(2)
    if str(tests) not in sys.path:
        sys.path.append(str(tests))


class Option:
    """Beside the type of a parameter, what argparse shall know of its option: short names, ``help``, ``choices``, ``type`` and so on."""

    def __init__(self, *names: str, **words: Any) -> None:
        self.names, self.words = names, words


Folder = Annotated[Path, Option(type=Path, help="of the benchmark files; what WAYBOUND_BENCHMARKS names by default")]


def command(run: Callable[..., bool | str | tuple[str, bool] | None]) -> Callable[..., int]:
    """``main(arguments=None)`` of a benchmark: every parameter of ``run`` is an option; called at once where the module is the program.

    Text that ``run`` returns is printed; False, alone or behind text, is exit code 1. A default says the type of an option: False makes a
    flag, a tuple takes any number of values. Only a ``Folder`` has none.
    """

    def main(arguments: Sequence[str] | None = None) -> int:
        module = sys.modules[run.__module__]
        name = module.__spec__.name if module.__spec__ else run.__module__
        parser = argparse.ArgumentParser(prog=f"python -m {name}", description=(module.__doc__ or "").splitlines()[0])
        for key, parameter in inspect.signature(run, eval_str=True).parameters.items():
            default = parameter.default
            words: dict[str, Any] = {"default": default}
            names = [f"--{key.replace('_', '-')}"]
            if default is parameter.empty:
                words["default"] = os.environ.get("WAYBOUND_BENCHMARKS")
            elif default is False:
                words["action"] = "store_true"
            elif isinstance(default, tuple):
                words |= {"nargs": "*", "type": type(default[0]) if default else str}
            elif default is not None:
                words["type"] = type(default)
            for details in getattr(parameter.annotation, "__metadata__", ()):
                names += details.names
                words |= details.words
            parser.add_argument(*names, **words)
        chosen = vars(parser.parse_args(arguments))
        if chosen.get("folder", "") is None:
            parser.error("--folder or WAYBOUND_BENCHMARKS must name the folder of the files")
        result = run(**chosen)
        text, good = result if isinstance(result, tuple) else (result, True) if isinstance(result, str) else ("", result)
        if text:
            print(text)
        return 1 if good is False else 0

    if run.__module__ == "__main__":
        sys.exit(main())
    return main


def timed(work: Callable[[], T]) -> tuple[float, T]:
    """CPU seconds of this process, and what ``work`` returns."""
    began = time.process_time()
    result = work()
    return time.process_time() - began, result


def solved(program: Program, name: str, limit: float, /, **own: Any) -> tuple[float, RawResult]:
    """CPU seconds of a solver, with options of its own, on a program that is there, and its account."""
    backend = solver_named(name)
    assert isinstance(backend, ProgramBackend)
    return timed(lambda: backend.run(program, Options(time_limit=limit, extra=own), Control()))


def generated(kind: type[T], recipe: str, seed: int, **settings: Any) -> T:
    """An instance of a recipe, which makes this kind of them."""
    instance = generate(recipe, seed, **settings)
    assert isinstance(instance, kind)
    return instance


def best_of(repeats: int, *works: Callable[[], Any]) -> list[float]:
    """Least CPU seconds of each of ``works``, which take turns, so that whatever else the machine does falls on all of them."""
    runs = [[timed(work)[0] for work in works] for _ in range(repeats)]
    return [min(seconds) for seconds in zip(*runs, strict=True)]


def in_a_fresh_process(*arguments: object, python: str = sys.executable) -> dict[str, Any]:
    """The JSON in the last line that ``python ARGUMENTS`` prints; raises RuntimeError with what it complains of."""
    done = subprocess.run([python, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return dict(json.loads(done.stdout.splitlines()[-1]))


def markdown(heads: Sequence[object], rows: Iterable[Sequence[object]] = ()) -> list[str]:
    """Lines of a Markdown table."""
    return [*(markdown_row(row) for row in (heads, ["---"] * len(heads), *rows))]


def markdown_row(cells: Sequence[object]) -> str:
    """One line of a Markdown table."""
    return "| " + " | ".join(map(str, cells)) + " |"


def met(good: bool) -> str:
    """The word for a target that is reached or missed."""
    return "met" if good else "MISSED"
