"""What each output of an answer to a routing problem says of the schedule, and whether that is one schedule, of the data, and judged.

The schedule of the tables is held against the data by plain loops; all other outputs are held against the tables.
"""

import io
import json
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from waybound import Route, Routes, RoutingProblem
from waybound.formulations.answer_tables import first_sheet, frame_of, workbook
from waybound.formulations.routing.parse_routes import routes_given
from waybound.formulations.routing.rolling_horizon import continued
from waybound.instances.clock import Clock
from waybound.reports.benchmarks.routing_variants import drawn, risky
from waybound.reports.tables.answers import answer_tables
from waybound.reports.tables.table import short

Rng = np.random.Generator
TIMES = ["arrival", "begin", "departure"]
NEAR = 1e-9
"""Part of the largest moment by which two tellings of one may differ."""


@dataclass(frozen=True)
class Told:
    """Of one route: departure, return, and arrival, begin and departure at each stop."""

    departure: float
    finish: float
    stops: np.ndarray[Any, Any]


def a_problem(seed: int, number: int) -> RoutingProblem:
    """Small, of the whole vocabulary in turn; some on the globe, some with times that are moments."""
    made = (risky if number % 7 == 6 else drawn)(seed, number)
    rng = np.random.default_rng([seed, number, 1])
    if rng.random() < 0.2 and made.sites.coordinates is not None:
        made = replace(made, sites=replace(made.sites, geographic=True))
    if rng.random() < 0.1:
        unit, zone = str(rng.choice(["min", "s", "h"])), str(rng.choice(["", "+02:00", "of day"]))
        made = replace(made, clock=Clock(unit, of_day=True) if zone == "of day" else Clock(unit, f"2026-05-04T00:00:00{zone}"))
    return made


def an_answer(problem: RoutingProblem, rng: Rng) -> Routes:
    """Any routes: customers in any order on vehicles of any type, with stops at depots where these may be, feasible or not."""
    customers = rng.permutation(problem.customers).tolist()[: int(rng.integers(1, len(problem.customers) + 1))]
    routes = []
    while customers:
        size, kind = int(rng.integers(1, len(customers) + 1)), int(rng.integers(len(problem.fleet)))
        visits, customers = customers[:size], customers[size:]
        pauses = [*problem.fleet[kind].reloads, *problem.fleet[kind].stations]
        for _ in range(int(rng.integers(0, 3)) if pauses and size > 1 else 0):
            visits.insert(int(rng.integers(1, len(visits))), int(rng.choice(pauses)))
        routes.append(Route(tuple(visits), kind))
    return Routes(tuple(routes))


def numbers(problem: RoutingProblem, column: Any) -> Any:
    """Moments and times of day as times of the problem."""
    clock = problem.clock
    if clock is not None and clock.of_day:
        return (pd.to_timedelta(pd.Series(list(column), dtype=str)) / pd.Timedelta(seconds=clock.seconds)).to_numpy(dtype=float)
    if clock is None or not clock.origin:
        return np.asarray(column, dtype=float)
    moments = pd.DatetimeIndex(list(column))
    start = clock.midnight
    if start is not None and start.tzinfo is not None and moments.tz is None:
        moments = moments.tz_localize(start.tzinfo)
    return ((moments - start) / pd.Timedelta(seconds=clock.seconds)).to_numpy(dtype=float)


def slack(problem: RoutingProblem, *moments: Any) -> float:
    """By how much two tellings of these moments may differ: rounding, and where they are dates a millisecond."""
    most = max((float(np.abs(m).max()) for m in moments if np.size(m)), default=0.0)
    clock = problem.clock
    return NEAR * max(most, 1.0) + (0.0011 / clock.seconds if clock is not None and (clock.origin or clock.of_day) else 0.0)


def of_tables(problem: RoutingProblem, visits: Any, routes: Any) -> list[Told]:
    """From the tables of visits and of routes."""
    ends = [numbers(problem, routes[title]).tolist() for title in ("departure", "return")]
    stops, of = np.column_stack([numbers(problem, visits[title]) for title in TIMES]), np.array(visits["vehicle"].tolist())
    return [Told(departure, finish, stops[of == name]) for name, departure, finish in zip(routes["vehicle"].tolist(), *ends, strict=True)]


def against_data(problem: RoutingProblem, answer: Routes, told: list[Told], routes: Any) -> list[str]:
    """Faults of tables: times that do not come of the ones before, or that no limit or objective was judged by."""
    faults, sites, verdict = [], problem.sites, problem.evaluate(answer)
    astray = {(v.vehicle, v.site) for v in verdict.violations if v.check == "timetable"}
    late = {(v.vehicle, v.site) for v in verdict.violations if v.check == "time-windows"}
    lasting = {v.vehicle for v in verdict.violations if v.check == "duration"}
    for route, one, name, duration in zip(answer, told, routes["vehicle"], routes["duration"], strict=True):
        vehicle, travel = problem.fleet[route.vehicle], problem.travel_of(route.vehicle)
        near = slack(problem, one.stops, one.departure, one.finish)
        clock, at = one.departure, vehicle.start
        opens = max(float(sites.ready[at]), vehicle.shift[0])
        if clock < opens - near and (name, sites.ids[at]) not in astray:
            faults.append(f"{name} departs at {clock}, before {opens}")
        for site, (arrival, begin, leaves) in zip(route.visits, one.stops.tolist(), strict=True):
            if abs(arrival - clock - float(travel.durations[at, site])) > near:
                faults.append(f"{name} reaches {site} at {arrival}, having left at {clock}")
            rest = leaves - begin - float(sites.service[site])
            if begin < arrival - near or rest < -near or (rest > near and route.timetable is None):
                faults.append(f"{name} begins {site} at {begin} and leaves at {leaves}, having come at {arrival}")
            windows = (
                sites.windows[site] if sites.windows and sites.windows[site] else ((float(sites.ready[site]), float(sites.due[site])),)
            )
            if not any(a - near <= begin <= b + near for a, b in windows) and (name, sites.ids[site]) not in late:
                faults.append(f"{name} begins {site} at {begin}, outside its windows, and nobody said so")
            clock, at = leaves, site
        if abs(one.finish - clock - float(travel.durations[at, vehicle.end])) > near:
            faults.append(f"{name} returns at {one.finish}, having left at {clock}")
        if abs(one.finish - one.departure - duration) > 2.0 * near:
            faults.append(f"{name} lasts {duration}, from {one.departure} to {one.finish}")
        if duration > vehicle.max_duration + near and name not in lasting:
            faults.append(f"{name} lasts {duration}, longer than {vehicle.max_duration}, and nobody said so")
        energy = vehicle.energy
        elapsed = {"elapsed": duration, "elapsed-fixed-start": one.finish - opens}
        if energy is not None and energy.charge in elapsed and not energy.stations:
            over = energy.rate * (elapsed[energy.charge] - near) > energy.at_departure * (1.0 + NEAR)
            if over and (name, "energy") not in {(v.vehicle, v.check) for v in verdict.violations}:
                faults.append(f"{name} draws for {elapsed[energy.charge]}, more than it has, and nobody said so")
    return faults + _against_objective(problem, answer, told, routes, verdict)


def _against_objective(problem: RoutingProblem, answer: Routes, told: list[Told], routes: Any, verdict: Any) -> list[str]:
    """The terms of the objective from the table of routes; vehicles that drive home idle are in no table."""
    sites = problem.sites
    near = slack(problem, *[one.finish for one in told]) * (len(told) + 1)
    faults = []
    served = [float(sites.service[list(route.visits)].sum()) for route in answer]
    waited = sum(float((one.stops[:, 2] - one.stops[:, 0]).sum()) - busy for one, busy in zip(told, served, strict=True))
    if any(v.committed for v in problem.fleet):
        return faults
    if abs(waited - verdict.quantities["waiting"]) > near * (1 + sum(map(len, answer))):
        faults.append(f"{waited} is waited in the table, {verdict.quantities['waiting']} as judged")
    visited = {k for route in answer for k in route.visits}
    opens = min(max(float(sites.ready[v.start]), v.shift[0]) for v in problem.fleet)
    terms = {
        "total-cost": routes["cost"].sum(), "total-duration": routes["duration"].sum(), "makespan": routes["duration"].max(),
        "longest-route": routes["distance"].max(), "vehicles": len(routes), "latest-return": max([opens, *(one.finish for one in told)]),
        "reward": sites.reward[sites.depots].sum() + sum(float(sites.reward[k]) for r in answer for k in r.visits if not sites.depot[k]),
        "penalties": sum(float(sites.penalty[k]) for k in problem.customers.tolist() if k not in visited),
    }  # fmt: skip
    for level, value in zip(problem.objective.levels(), verdict.values, strict=True):
        made = sum(weight * terms[term.name] for weight, term in level.terms)
        if abs(made - value) > near * sum(abs(weight) for weight, _ in level.terms) + NEAR * max(abs(made), abs(value), *verdict.sizes):
            faults.append(f"{level} is {made} by the table, {value} as judged")
    return faults


def _differ(problem: RoutingProblem, name: str, told: list[Told], other: list[Told]) -> list[str]:
    near = slack(problem, *[one.stops for one in told], *[one.finish for one in told])
    pairs = [
        (np.r_[a.departure, a.finish, a.stops.ravel()], np.r_[b.departure, b.finish, b.stops.ravel()])
        for a, b in zip(told, other, strict=True)
    ]
    # What an output does not tell is NaN.
    return [f"{name}: {b} where the tables have {a}" for a, b in pairs if len(a) != len(b) or np.nanmax(np.abs(a - b), initial=0.0) > near]


def of_vroom(problem: RoutingProblem, answer: Routes) -> list[Told]:
    made = []
    for route in json.loads(problem.answer_to_text(answer, ".vroom"))["routes"]:
        first, *steps, last = route["steps"]
        rows = [(s["arrival"], s["arrival"] + s["waiting_time"], s["arrival"] + s["waiting_time"] + s["service"]) for s in steps]
        made.append(Told(first["arrival"], last["arrival"], np.array(rows)))
    return made


def of_geojson(problem: RoutingProblem, answer: Routes) -> list[Told]:
    features = [f["properties"] for f in json.loads(problem.answer_to_text(answer, ".geojson"))["features"]]
    points = {row["id"]: row for row in features if row["kind"] == "site"}
    made = []
    for row in (row for row in features if row["kind"] == "route"):
        ends = [float(numbers(problem, [row[key]])[0]) for key in ("departure", "return")]
        stops = [[float(numbers(problem, [points[s][t]])[0]) for t in TIMES] if s in points else [math.nan] * 3 for s in row["visits"]]
        made.append(Told(*ends, np.array(stops)))
    return made


def of_picture(problem: RoutingProblem, answer: Routes) -> list[Told]:
    """The bars of service, and the marks at both ends of a route, of the chart of the schedule."""
    from matplotlib import pyplot as plt

    from waybound.reports.plots.routing.schedule import plot_schedule

    ax = plot_schedule(problem, answer, ax=plt.figure().add_subplot())
    marks = [
        line.get_xdata() for line in ax.lines if line.get_marker() == "|" and line.get_markersize() == 9 and len(line.get_xdata()) == 2
    ]
    bars = [(round(bar.get_y() + 0.21), bar.get_x()) for bar in ax.patches if abs(bar.get_height() - 0.42) < 1e-9]
    moves = [
        [segment[:, 0] for segment in lines.get_segments()]
        for lines in ax.collections
        if lines.get_linewidth()[0] == 1.1 and lines.get_zorder() == 2
    ]
    plt.close(ax.figure)
    made = []
    for k, (departure, finish) in enumerate(marks):
        begins = [x for row, x in bars if row == k]
        arrivals, leaves = [float(m[1]) for m in moves[k][:-1]], [float(m[0]) for m in moves[k][1:]]
        made.append(Told(float(departure), float(finish), np.column_stack([arrivals, begins, leaves])))
    return made


def faults_of(problem: RoutingProblem, answer: Routes, *, picture: bool = False, sheets: bool = False) -> list[str]:
    """Whatever is wrong with what is told of this answer: in tables, files, text and pictures."""
    frames = problem.answer_frames(answer)
    visits, routes = frames["visits"], frames["routes"]
    told = of_tables(problem, visits, routes)
    faults = against_data(problem, answer, told, routes)
    if (picture or sheets) and not visits.equals(problem.answer_to_frame(answer)):
        faults.append("the table of visits is another one")
    others = {}
    # VROOM's output has neither stops at depots on the way nor waiting after a service.
    if not any(v.reloads or v.stations for v in problem.fleet) and answer == answer.untimed():
        others["vroom"] = of_vroom(problem, answer)
    if problem.sites.geographic:
        others["geojson"] = of_geojson(problem, answer)
    if picture:
        others["picture"] = of_picture(problem, answer)
    csv = frame_of(visits.to_csv(index=False))
    others["csv"] = of_tables(problem, csv, routes)
    if sheets:
        data = workbook(frames)
        read = pd.read_excel(io.BytesIO(data), sheet_name=None)
        others["xlsx"] = of_tables(problem, read["visits"], read["routes"])
    for name, other in others.items():
        faults += _differ(problem, name, told, other)
    for row, line in zip(routes.itertuples(), answer_tables(problem, answer)[0].rows, strict=False):
        if line[4] != short(row.duration):
            faults.append(f"the table on the terminal has duration {line[4]}, the frame {row.duration}")
    sources = [csv, *([visits] if picture else []), *([first_sheet("a.xlsx", data)] if sheets else [])]
    for k, source in enumerate(sources):
        again = routes_given(problem, source)
        stated = answer != answer.untimed()
        same = again.untimed() == answer.untimed() if stated else again.canonical() == answer.canonical()
        if not same:
            faults.append(f"table {k} reads back as {again}, not {answer}")
        elif stated:
            frames = problem.answer_frames(again)
            faults += _differ(problem, f"table {k} read back", told, of_tables(problem, *frames.values()))
    if problem.answer_from_json(json.loads(json.dumps(problem.answer_to_json(answer)))) != answer:
        faults.append("its JSON reads back as another answer")
    return faults


def changed(problem: RoutingProblem, answer: Routes, rng: Rng) -> tuple[Any, float]:
    """The table of visits with one time, or all from one on, moved; and by how much."""
    frame = problem.answer_to_frame(answer)
    row, title = int(rng.integers(len(frame))), str(rng.choice(TIMES))
    by = float(rng.choice([-1.0, 1.0])) * float(rng.choice([1.0, 2.5, 7.0, 40.0]))
    moment: Any = by if problem.clock is None else pd.Timedelta(seconds=by * problem.clock.seconds)
    onward, same = rng.random() < 0.5, (frame["vehicle"] == frame["vehicle"].iloc[row]).tolist()
    for at, other in enumerate(TIMES):
        after = [same[k] and (k > row or (k == row and at >= TIMES.index(title))) for k in range(len(frame))]
        moved = after if onward else [k == row and other == title for k in range(len(frame))]
        frame[other] = [time + moment if m else time for time, m in zip(frame[other].tolist(), moved, strict=True)]
    return frame, by


def of_changed(problem: RoutingProblem, frame: Any, *, every: bool = False) -> list[str]:
    """What is wrong with the verdict on a table of visits with times of its own: it tells these times, or says which are wrong; and with
    ``every`` output of it."""
    answer = routes_given(problem, frame)
    told, routes = problem.answer_frames(answer).values()
    faults = against_data(problem, answer, of_tables(problem, told, routes), routes)
    faults += faults_of(problem, answer) if every else []
    verdict = problem.evaluate(answer)
    wrong = {(v.vehicle, v.site) for v in verdict.violations if v.check == "timetable"}
    rows = frame.set_index(["vehicle", "position"]).loc[list(zip(told["vehicle"], told["position"], strict=True))]
    near = slack(problem, *[numbers(problem, frame[title]) for title in TIMES])
    digit = max([near, *(route.timetable.digit for route in answer if route.timetable is not None)])
    for title in TIMES:
        stated, shown = numbers(problem, rows[title]), numbers(problem, told[title])
        for vehicle, site, a, b in zip(told["vehicle"], told["site"], stated, shown, strict=True):
            if abs(a - b) > 1.001 * digit + near and (vehicle, site) not in wrong:
                faults.append(f"{title} of {site} is stated as {a} and told as {b}, and nobody says so")
    if verdict.feasible:
        faults += [f"a timetable that is wrong at {sorted(wrong)} is called feasible"] if wrong else []
    return faults


def horizon_agrees(problem: RoutingProblem, answer: Routes, time: float) -> list[str]:
    """What continues a plan takes the schedule that the tables show."""
    told = problem.answer_to_frame(answer)
    begun = set(told["site"][numbers(problem, told["begin"]) < time])
    left = continued(problem, answer, time)
    again = begun & {left.sites.ids[k] for k in left.customers.tolist()}
    return [f"{sorted(again)} have begun before {time} and are planned again"] if again else []
