"""Tables of a campaign folder by folder: gaps to the best values known, proofs, and seconds of the processor.

A row is a method on the files of a folder; one that can take none of them has no row. Gaps in per cent and CPU seconds are medians, with
the largest in parentheses. *All prove* is the geometric mean of CPU seconds over what all methods of a table prove. Exits with 1 if an
answer failed a check, a run ended in an error, a verified bound excludes the best value known, or somebody has a better answer than one
that is said to be optimal.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from waybound.reports.campaigns.campaign import Campaign, read_campaign
from waybound.reports.campaigns.counting import counted
from waybound.reports.campaigns.frames import of_runs, results

from ._harness import Option, command, markdown

if TYPE_CHECKING:
    import pandas as pd

HEADS = ("method", "runs", "answers", "proved", "verified", "to best known", "to own bound", "bound to best known", "CPU s", "all prove")


def runs_of(campaign: Campaign) -> pd.DataFrame:
    """The runs of a campaign that are done, with what they are compared with, the ``folder`` of the file and the gap to their own bound."""
    runs = counted(of_runs(results(campaign.results), {run.key for run in campaign.runs}), campaign.best_known_values())
    places = {run.instance.hash: run.instance.path.resolve().parent for run in campaign.runs}
    different = {*places.values()}
    above = os.path.commonpath(different if len(different) > 1 else [place.parent for place in different])
    runs["folder"] = [f"{os.path.relpath(places[h], above)}{way(r)}" for h, r in zip(runs["file_hash"], runs["reading"], strict=True)]
    runs["own_gap"] = (runs["objective"] - runs["bound"]).abs() / runs["objective"].abs()
    runs["proved"] = runs["counts"] & (runs["status"] == "optimal") & runs["bound"].notna()
    runs["bound_gap"] = (runs["verified_bound"] - runs["known"]).abs() / runs["known"].abs()
    return runs[runs["error_code"] != "unsupported"]


def way(reading: str) -> str:
    """The problem and the changes that make something else of a file than it stands for."""
    read = json.loads(reading)
    return "".join(f", {word}" for word in (read["problem"], *(f"{key}={value}" for key, value in read["changes"].items())) if word)


def excluding(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs whose verified bound excludes the best value known, of values that were published rounded."""
    beyond = (runs["verified_bound"] - runs["known"]).where(runs["sense"] == "min", runs["known"] - runs["verified_bound"])
    return runs[beyond > 1e-6 * runs["known"].abs()]


def surpassed(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs whose answer is said to be optimal, while another one is better."""
    return runs[runs["proved"] & (runs["gap_to_best"] > 1e-6)]


def tables(runs: pd.DataFrame) -> Iterator[str]:
    """A table a folder."""
    for folder, own in runs.groupby("folder"):
        of_case = own.groupby(["case", "seed"])
        shared = own[of_case["proved"].transform("all") & (of_case["who"].transform("nunique") == own["who"].nunique())]
        rows = []
        for who, of in own.groupby("who"):
            cpu = shared[shared["who"] == who]["cpu_seconds"].clip(lower=0.01).to_numpy()
            rows.append([
                f"`{who}`", len(of), of["counts"].sum(), of["proved"].sum(), (of["proved"] & (of["bound_kind"] == "verified")).sum(),
                *(spread(100.0 * of[name]) for name in ("gap_to_known", "own_gap", "bound_gap")), spread(of["cpu_seconds"]),
                f"{(cpu.prod() ** (1 / len(cpu))):.1f} ({len(cpu)})" if len(cpu) else "",
            ])  # fmt: skip
        yield "\n".join([f"\n### {folder}\n", *markdown(HEADS, rows)])


def spread(figures: pd.Series[float]) -> str:
    """The median and, in parentheses, the largest."""
    there = figures.dropna()
    return f"{there.median() + 0.0:.2f} ({there.max() + 0.0:.2f})" if len(there) else ""


@command
def main(campaign: Annotated[str, Option(required=True, help="its file")] = "") -> bool:
    runs = runs_of(read_campaign(Path(campaign)))
    for text in tables(runs):
        print(text)
    wrong, failed = excluding(runs), runs[(runs["status"] == "error") | (runs["faults"].fillna(0) > 0)]
    for row in wrong.itertuples():
        print(f"{row.instance}: {row.who} has the verified bound {row.verified_bound}, best known {row.known}", file=sys.stderr)
    for row in surpassed(runs).itertuples():
        print(f"{row.instance}: {row.who} calls {row.objective} optimal, {row.best} is better", file=sys.stderr)
    for row in failed.itertuples():
        print(f"{row.instance}: {row.who}: {row.reason}", file=sys.stderr)
    return wrong.empty and failed.empty and surpassed(runs).empty
