"""Does what a page says, word for word, and prints what came out otherwise than the page shows it.

A page is made of files (blocks after a line that names them), console sessions and Python sessions; a block that is none of these is a
fault. ``pip install`` is done without pip, for it takes seconds: modules and entry points are put where pip puts them.
"""

import doctest
import importlib
import io
import re
import shlex
import shutil
import sys
import tomllib
from pathlib import Path

FENCE = re.compile(r"(?:^`([\w.-]+)`:\n\n)?^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def install(project: Path, site: Path) -> None:
    """Modules and entry points of a project, as ``pip install`` leaves them."""
    told = tomllib.loads((project / "pyproject.toml").read_text())
    name, version = told["project"]["name"], told["project"]["version"]
    for module in told["tool"]["setuptools"]["py-modules"]:
        shutil.copy(project / f"{module}.py", site)
    made = site / f"{name.replace('-', '_')}-{version}.dist-info"
    made.mkdir()
    (made / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    groups = told["project"]["entry-points"].items()
    points = ("\n".join([f"[{group}]", *(f"{key} = {value}" for key, value in entries.items())]) for group, entries in groups)
    (made / "entry_points.txt").write_text("\n".join(points) + "\n")
    importlib.invalidate_caches()


def console(text: str, site: Path) -> list[str]:
    """Faults of a console session: commands after ``$``, and what each prints, on standard error where it fails."""
    from typer.testing import CliRunner

    from waybound.cli.app import app

    faults = []
    for command, shown in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", text, flags=re.MULTILINE):
        words = shlex.split(command)
        if words == ["pip", "install", "."]:
            install(Path(), site)
            continue
        assert words[0] == "waybound", command
        ended = CliRunner(env={"COLUMNS": "120"}).invoke(app, words[1:])
        printed = ended.stdout if ended.exit_code == 0 else f"{ended.output}[exit code {ended.exit_code}]\n"
        if not doctest.OutputChecker().check_output(shown, printed, FLAGS):
            faults.append(f"$ {command}\n{printed}--- the page shows\n{shown}")
    return faults


def session(text: str, names: dict[str, object]) -> list[str]:
    """Faults of a Python session."""
    test = doctest.DocTestParser().get_doctest(text, names, "page", None, None)
    test.globs = names  # the parser has made a copy
    told = io.StringIO()
    doctest.DocTestRunner(optionflags=FLAGS).run(test, out=told.write, clear_globs=False)
    return [told.getvalue()] if told.getvalue() else []


def run_page(page: Path, site: Path) -> list[str]:
    """Faults of a page; files are written into the working directory."""
    names: dict[str, object] = {}
    faults: list[str] = []
    for file, language, text in FENCE.findall(page.read_text(encoding="utf-8")):
        if file:
            Path(file).write_text(text)
        elif language == "console":
            faults += console(text, site)
        elif language == "python" and text.startswith(">>> "):
            faults += session(text, names)
        else:
            faults.append(f"a block that nothing runs:\n{text}")
    return faults


if __name__ == "__main__":
    found = run_page(Path(sys.argv[1]), Path(sys.argv[2]))
    print("\n".join(found))
    sys.exit(bool(found))
