"""False words of versions of HiGHS about small routing programs, by themselves: the bare library with its own options.

Each version is installed by pip into a folder that is deleted afterwards; the installed one is left alone. Programs and optima are the
battery's, of the kind ``time-windows``.
"""

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from waybound.instances.errors import WayboundError
from waybound.reports.battery.cases import Draw, cases
from waybound.reports.battery.truth import Truth

from ._harness import Option, command

VERSIONS = ("1.10.0", "1.11.0", "1.12.0", "1.13.1", "1.14.0", "1.15.1")
FORMS = ("two-index-mtz", "three-index")
KIND = "time-windows"
EQUAL = 1e-5
"""Relative difference up to which a value is the optimum."""


def written(form: str, count: int, seed: int, file: Path) -> list[Truth]:
    """The programs of a draw in one file, and what is true of them."""
    arrays: dict[str, Any] = {"count": count}
    true = []
    for k, case in enumerate(cases(Draw(count, seed, KIND, form))):
        p = case.program
        assert p.sense == "min" and p.offset == 0 and p.quadratic is None
        for name in ("cost", "lower", "upper", "row_lower", "row_upper", "indptr", "indices", "data", "integer"):
            arrays[f"{k}/{name}"] = getattr(p, name)
        true.append(case.truth)
    np.savez(file, **arrays)
    return true


def installed(version: str, folder: Path) -> None:
    """Put one version into a folder; raises WayboundError where pip cannot."""
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"]
    done = subprocess.run([*pip, "--target", str(folder), f"highspy=={version}"], capture_output=True, text=True, check=False)
    if done.returncode:
        raise WayboundError(f"highspy {version} cannot be installed: {(done.stderr.strip().splitlines() or ['pip failed'])[-1]}")


def said(folder: Path, programs: Path, options: dict[str, Any]) -> tuple[str, list[tuple[str, float]]]:
    """The version that is in ``folder``, and its word on each program."""
    words = [sys.executable, str(Path(__file__).with_name("_bare_highs.py")), str(folder), str(programs), json.dumps(options)]
    version, *lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()
    verdicts = (line.split("\t") for line in lines if "\t" in line)
    return version, [(status, float(value)) for status, value in verdicts]


def wrong(true: Sequence[Truth], verdicts: Sequence[tuple[str, float]]) -> tuple[int, int]:
    """False infeasibilities and wrong optima."""
    empty = optima = 0
    for truth, (status, value) in zip(true, verdicts, strict=True):
        if status == "Infeasible":
            empty += truth.value is not None
        elif status == "Optimal":
            optima += truth.value is None or abs(value - float(truth.value)) > EQUAL * max(1.0, abs(float(truth.value)))
    return empty, optima


Words = Annotated[tuple[str, ...], Option(nargs="+")]


@command
def main(
    versions: Words = VERSIONS,
    forms: Words = FORMS,
    count: int = 1500,
    seed: int = 1,
    option: Annotated[list[str] | None, Option(action="append", metavar="KEY=VALUE", help="of HiGHS, for all versions")] = None,
) -> None:
    options = {key: int(value) if value.isdigit() else value for key, _, value in (o.partition("=") for o in option or ())}
    with tempfile.TemporaryDirectory() as place:
        files = {form: Path(place) / f"{form}.npz" for form in forms}
        true = {form: written(form, count, seed, file) for form, file in files.items()}
        print(f"{count} programs of {KIND} each, options {options or 'its own'}: false infeasible / wrong optimum")
        print("| version |" + "".join(f" `{form}` |" for form in files) + "\n|---|" + "---|" * len(files))
        for version in versions:
            folder = Path(place) / version
            try:
                installed(version, folder)
            except WayboundError as fault:
                print(f"| {version} | {fault} |")
                continue
            words = {form: said(folder, file, options) for form, file in files.items()}
            counts = [f" {a} / {b} |" for a, b in (wrong(true[form], verdicts) for form, (_, verdicts) in words.items())]
            print(f"| {next(iter(words.values()))[0]} |" + "".join(counts), flush=True)
