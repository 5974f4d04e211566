"""The reference of the command line, from the commands themselves."""

from collections.abc import Iterator
from typing import Any

import typer.main
from markdown_tables import markdown_table, plain

from waybound.cli.app import app

HEAD = """# Command line

Made from the commands themselves; `waybound COMMAND --help` says the same. {codes}

`waybound --install-completion` teaches your shell (bash, zsh, fish, PowerShell) the commands, their options, and the names of solvers,
heuristics, forms, problems, formats, conventions, generators, missions, studies and bundled instances; `--show-completion` shows what it
would add. A misspelt name is answered with the nearest one.
"""


def page() -> str:
    """The whole page: one section a command."""
    root = typer.main.get_command(app)
    parts = [HEAD.format(codes=plain(root.epilog or ""))]
    parts += [_section(name, command) for name, command in _commands(root, "waybound")]
    return "\n".join(parts)


def _commands(group: Any, above: str) -> Iterator[tuple[str, Any]]:
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from _commands(command, f"{above} {name}")
        else:
            yield f"{above} {name}", command


def _section(name: str, command: Any) -> str:
    shown = [p for p in command.params if not getattr(p, "hidden", False)]
    arguments = [p for p in shown if p.param_type_name == "argument"]
    options = [p for p in shown if p.param_type_name == "option"]
    usage = " ".join([name, "[OPTIONS]", *(_argument(a) for a in arguments)])
    rows = [(f"`{_argument(a)}`", plain(getattr(a, "help", None) or "", keep="`")) for a in arguments]
    rows += [(_option(o), plain(o.help or "", keep="`")) for o in options]
    text = f"## {name}\n\n{plain(command.help or '', keep='`')}\n\n```text\n{usage}\n```\n"
    return text + (f"\n{markdown_table(('argument or option', 'what it does'), rows)}\n" if rows else "")


def _argument(argument: Any) -> str:
    return str(argument.metavar or argument.name.upper())


def _option(option: Any) -> str:
    names = ", ".join(f"`{name}`" for name in (*option.opts, *option.secondary_opts))
    if option.is_flag:
        return names
    kind = option.metavar or option.type.name.upper()
    default = option.default
    told = f", by default `{default}`" if isinstance(default, int | float | str) and not callable(default) else ""
    return f"{names} {plain(kind)}{told}"
