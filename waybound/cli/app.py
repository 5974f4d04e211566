"""The application: all commands, registered."""

from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from . import benching, comparing, files, judging, listing, reporting, running, solving, warming
from .handling import handled, print_failure


class Commands(TyperGroup):
    """Commands that also say as JSON, where ``--json`` asks for it, which of their options is wrong."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        ctx.meta["waybound.json"] = "--json" in args
        return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except Exception as fault:
            if ctx.meta["waybound.json"] and hasattr(fault, "format_message"):  # Typer's own, which goes on to tell it in words
                print_failure(fault.format_message(), getattr(fault, "exit_code", 2), fault)
            raise


app = typer.Typer(
    name="waybound",
    cls=Commands,
    help="Routing for vehicle fleets and robot teams: answers that carry their own evidence.",
    epilog="Exit codes: 0 a verified answer, 1 internal error, 2 usage or bad input, 3 proven infeasible or unbounded, "
    "4 no answer within the limit, 5 a check failed, 130 interrupted without an answer (143 by SIGTERM, 129 by SIGHUP).",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        from .. import __version__

        typer.echo(f"waybound {__version__}")
        raise typer.Exit()


@app.callback()
def _root(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version and exit.")] = False,
) -> None:
    pass


for _command in (
    solving.solve, comparing.compare, benching.bench, judging.check, judging.bound, judging.explain, listing.info,
    files.export, files.convert,
    files.generate,
    listing.solvers, listing.heuristics, reporting.ratio, reporting.report, running.run, warming.warm,
):  # fmt: skip
    app.command()(handled(_command))
app.add_typer(listing.instances, name="instances")
