"""``waybound run``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..instances.errors import UsageError
from ..solvers import interrupts
from . import completing
from .delivery import Delivery, check_matplotlib, check_outputs
from .handling import complain, remark
from .options import Json, Quiet, Verbose, arg, bounded, opt, parse_pairs
from .output import stdout_is_ours, table_text
from .progress import Progress

if TYPE_CHECKING:
    import pandas as pd

    from ..reports.missions.mission import Mission

ANIMATION_SUFFIXES = (".gif", ".html")


def run(
    mission: Annotated[str, arg("MISSION", "tracking, ...; an unknown one lists them all.", completing.names("mission"))],
    solver: Annotated[str | None, opt("--solver NAME", "What solves the problems. See `waybound solvers`.", "solver")] = None,
    heuristic: Annotated[
        str | None, opt("--heuristic NAME", "An approximation instead of a solver. See `waybound heuristics`.", "heuristic")
    ] = None,
    policy: Annotated[
        str | None, opt("--policy NAME", "A rule of the mission's own that solves no problem; an unknown one lists them.")
    ] = None,
    against: Annotated[
        str | None, opt("--against KIND:NAME", "A second method, shown beside the first: solver:, heuristic: or policy:NAME.")
    ] = None,
    steps: Annotated[int | None, opt("--steps N", "How long the mission lasts; by default to its end, if it has one.")] = None,
    seed: Annotated[int, opt("--seed N", "The same seed gives the same world, whatever decides.")] = 1,
    settings: Annotated[
        list[str] | None, opt("--set KEY=VALUE", "A setting of the mission; an unknown one lists them all. Repeatable.")
    ] = None,
    option: Annotated[list[str] | None, opt("--option KEY=VALUE", "An option of the solver or heuristic itself. Repeatable.")] = None,
    time_limit: Annotated[float, opt("--time-limit S", "Seconds for the search for each problem.")] = 60.0,
    bound_time: Annotated[float, opt("--bound-time S", "Seconds for bounding after it.")] = 0.0,
    out: Annotated[Path | None, opt("--out FILE", "Write the log, one row a step: .csv.")] = None,
    animation: Annotated[Path | None, opt("--animation FILE", "Show what happened: .gif, or .html with buttons.")] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Play a mission over time: agents observe, decide with any solver, heuristic or policy, and act, step by step."""
    from ..instances.worlds import setting_values
    from ..reports.missions.mission import MISSIONS

    bounded(time_limit=time_limit, bound_time=bound_time, steps=steps, seed=seed)
    values = parse_pairs(settings, "--set")
    played = MISSIONS[mission]()
    setting_values(mission, played.settings, values)
    _check_outputs(played, out, animation)
    other = None if against is None else _decider(against)
    if other is not None and animation is None:
        raise UsageError("--against shows a second method beside the first: give a file with --animation")

    from ..formulations.json_text import json_text
    from ..instances.atomic import atomic_write
    from ..reports.missions.running import run as play

    film = None
    if animation is not None:
        from ..reports.missions.animation import Film, save_side_by_side

        film = Film(played)
    interrupts.keep()
    with Progress(quiet) as progress, stdout_is_ours():
        log = play(
            played, solver=solver, heuristic=heuristic, policy=policy, steps=steps, seed=seed, time_limit=time_limit, bound_time=bound_time,
            options=parse_pairs(option, "--option"), watch=film, progress=progress, **values,
        )  # fmt: skip
        beside, second = None, None
        if other is not None and len(log) and log.attrs["limit"] != "interrupt":
            beside = Film(rival := MISSIONS[mission]())
            second = play(
                rival, **other, steps=steps, seed=seed, time_limit=time_limit, bound_time=bound_time, watch=beside, progress=progress,
                **values,
            )  # fmt: skip
    if not len(log):
        raise KeyboardInterrupt
    for fault in log.attrs["faults"]:
        complain(fault)
    if log.attrs["limit"] == "interrupt":
        remark(f"interrupted after {len(log)}{'' if steps is None else f' of {steps}'} steps")
    delivery = Delivery(verbose)
    delivery.file("--out", out, lambda path: atomic_write(path, log.to_csv(index=False)))
    if film is not None and beside is not None and second is not None and second.attrs["limit"] != "interrupt":
        films = {_named(log): film, _named(second): beside}
        delivery.file("--animation", animation, lambda path: save_side_by_side(films, path))
    elif film is not None:
        delivery.file("--animation", animation, film.save)
    delivery.show(lambda: json_text(_as_json(log)) if json else _shown(log, played), lambda: str(log.to_csv(index=False)))
    raise typer.Exit(5 if log.attrs["faults"] else delivery.code)


def _check_outputs(mission: Mission, out: Path | None, animation: Path | None) -> None:
    """Refuse now what could not be written after the run."""
    check_outputs((), out=(out, (".csv",)), animation=(animation, ANIMATION_SUFFIXES))
    if animation is not None:
        if not mission.drawable:
            raise UsageError(f"--animation: mission {mission.name} has no pictures", "unsupported")
        check_matplotlib("--animation")


def _decider(text: str) -> dict[str, Any]:
    """The deciding method as a keyword for ``run``."""
    kind, colon, name = text.partition(":")
    if kind not in ("solver", "heuristic", "policy") or not colon or not name:
        raise UsageError(f"--against takes solver:NAME, heuristic:NAME or policy:NAME, not {text!r}", "malformed")
    return {kind: name}


def _named(log: pd.DataFrame) -> str:
    return next((str(log.attrs[kind]) for kind in ("solver", "heuristic", "policy") if log.attrs.get(kind)), "default")


def _as_json(log: pd.DataFrame) -> dict[str, Any]:
    from .. import __version__

    means = {name: float(log[name].mean()) for name in _figures(log)}
    facts = {str(key): value for key, value in log.attrs.items()}
    return {"schema": 1, **facts, "steps": len(log), "waybound": __version__, "means": means, "rows": log.to_dict("records")}


def _figures(log: pd.DataFrame) -> list[str]:
    """Columns of numbers, without those that hold none."""
    numbers = log.select_dtypes("number").drop(columns="step")
    return [str(name) for name in numbers.columns if numbers[name].notna().any()]


def _shown(log: pd.DataFrame, mission: Mission) -> str:
    from ..formulations.rendering import number
    from ..reports.tables.table import Column, Table

    names = sorted(_figures(log), key=lambda name: name != mission.headline)
    rows = []
    for name in names:
        values = log[name].dropna()
        spread = (values.mean(), values.std(ddof=0), values.min(), values.max())
        rows.append((name, *(number(float(f"{v:.4g}") if abs(v) > 1e-9 else 0.0) for v in spread)))
    decider = next((f"{kind} {name}" for kind, name in log.attrs.items() if kind in ("solver", "heuristic", "policy") and name), "default")
    title = f"{mission.name}, {decider}: {len(log)} steps, seed {log.attrs['seed']}"
    columns = (Column("each step"), *(Column(head, right=True) for head in ("mean", "deviation", "least", "largest")))
    table = table_text(Table(title, columns, tuple(rows)))
    status = ", ".join(f"{name} {count}" for name, count in log["status"].value_counts().items())
    return table + table_text(Table("", (Column(""), Column("", wide=True)), (("status of steps", status),)))
