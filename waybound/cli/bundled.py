"""``waybound instances``: the bundled instances."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import Json, Verbose, handled
from .output import print_text, write_out

app = typer.Typer(help="Bundled instances.", no_args_is_help=True)

Name = Annotated[str, typer.Argument(metavar="NAME", help="Name of a bundled instance.", show_default=False)]


@app.command("list")
@handled
def list_all(json: Json = False, verbose: Verbose = False) -> None:
    """Bundled instances, and how each was made."""
    from ..instances.bundled import RECIPES, bundled_path

    if json:
        from .output import print_json

        rows = [
            {"name": n, "path": str(bundled_path(n)), "recipe": r.command(n) or None, "source": r.source or None}
            for n, r in RECIPES.items()
        ]
        print_json({"bundled": rows})
        return
    from ..reports.tables.table import Column, Table
    from .output import print_table

    print_table(
        Table("Bundled", (Column("name"), Column("made by", wide=True)), tuple((n, r.source or r.command(n)) for n, r in RECIPES.items()))
    )


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
