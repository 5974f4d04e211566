"""``waybound instances``: bundled instances, and public sets that can be fetched."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import Json, Verbose, handled
from .output import print_text, write_out

app = typer.Typer(help="Bundled instances, and public benchmark sets that can be fetched.", no_args_is_help=True)

Name = Annotated[str, typer.Argument(metavar="NAME", help="Name of a bundled instance.", show_default=False)]


@app.command("list")
@handled
def list_all(json: Json = False, verbose: Verbose = False) -> None:
    """Bundled instances, and the sets that `fetch` knows."""
    from ..instances.bundled import RECIPES, bundled_path
    from ..instances.fetch import SETS

    if json:
        from .output import print_json

        print_json(
            {
                "bundled": [
                    {"name": n, "path": str(bundled_path(n)), "recipe": r.command(n) or None, "source": r.source or None}
                    for n, r in RECIPES.items()
                ],
                "sets": [{"name": s.name, "summary": s.summary, "home": s.base_url, "status": s.status} for s in SETS.values()],
            }
        )
        return
    from ..reports.tables.table import Column, Table
    from .output import print_table

    print_table(
        Table("Bundled", (Column("name"), Column("made by", wide=True)), tuple((n, r.source or r.command(n)) for n, r in RECIPES.items()))
    )
    columns = (Column("set"), Column("holds"), Column("home", wide=True))
    rows = tuple((s.name, s.summary, f"{s.status}: {s.base_url}" if verbose else s.status) for s in SETS.values())
    print_table(Table("To fetch", columns, rows))


@app.command()
@handled
def path(name: Name, verbose: Verbose = False) -> None:
    """Where a bundled instance lies."""
    from ..instances.bundled import bundled_path

    print_text(str(bundled_path(name)))


@app.command()
@handled
def show(name: Name, verbose: Verbose = False) -> None:
    """The text of a bundled instance."""
    from ..instances.bundled import bundled_path

    write_out(bundled_path(name).read_text(encoding="utf-8"))


@app.command()
@handled
def fetch(
    name: Annotated[str, typer.Argument(metavar="SET", help="Name of a set; an unknown one lists them all.", show_default=False)],
    to: Annotated[
        Path | None, typer.Option("--to", metavar="FOLDER", help="Where to put it; a folder of the set's name by default.")
    ] = None,
    base_url: Annotated[str | None, typer.Option("--base-url", metavar="URL", help="Another home that holds the same archives.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing.")] = False,
    verbose: Verbose = False,
) -> None:
    """Download a public set; what arrives is checked before anything is kept."""
    from ..instances.fetch import fetch_set

    folder = Path(name) if to is None else to
    files = fetch_set(name, folder, base_url)
    if not quiet:
        print_text(f"{folder}: {len(files)} files of {name}")
    if verbose:
        for file in files:
            print_text(str(file))
