"""Notebooks: percent scripts of ``reports/notebooks``, executed and told as Markdown with their pictures."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jupytext
from nbclient import NotebookClient
from nbconvert import MarkdownExporter

FOLDER = Path(__file__).resolve().parents[2] / "reports" / "notebooks"

TIMEOUT = 180
"""Seconds that a cell may take."""


@dataclass(frozen=True)
class NotebookPage:
    """A page, its pictures by file name, and the notebook as Jupyter opens it."""

    text: str
    pictures: dict[str, bytes]
    notebook: str


def notebooks() -> list[Path]:
    """The scripts, in alphabetical order; the navigation puts them into that of reading."""
    return sorted(FOLDER.glob("*.py"))


def execute(script: Path) -> Any:
    """The notebook of a script, with what its cells gave.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell fails.
    RuntimeError
        If a cell warns, or writes to standard error: nothing of that kind goes to readers.
    """
    notebook = jupytext.read(script)
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")
    NotebookClient(notebook, timeout=TIMEOUT, resources={"metadata": {"path": str(FOLDER)}}).execute()
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            if output.get("name") == "stderr":
                raise RuntimeError(f"{script.name} writes to standard error: {output['text'].strip()}")
    return notebook


def page(script: Path, *, executed: bool = True) -> NotebookPage:
    """The page of a notebook; with ``executed=False`` its text and code alone."""
    notebook = execute(script) if executed else jupytext.read(script)
    exporter = MarkdownExporter()
    exporter.exclude_input_prompt = exporter.exclude_output_prompt = True
    text, resources = exporter.from_notebook_node(notebook, resources={"unique_key": script.stem})
    pictures = {Path(name).name: data for name, data in (resources.get("outputs") or {}).items()}
    for name in resources.get("outputs") or {}:
        text = text.replace(f"({name})", f"({Path(name).name})")
    note = f"*This page is a notebook: [open it in Jupyter]({script.stem}.ipynb){{ download }}; its script is `reports/notebooks/{script.name}`.*"
    title, _, rest = text.lstrip().partition("\n")
    return NotebookPage(f"{title}\n\n{note}\n{_tidied(rest)}", pictures, jupytext.writes(notebook, fmt="ipynb"))


def _tidied(text: str) -> str:
    """Outputs of plain text stand in blocks of their own, alternative texts say what they are, and tables can be scrolled on a phone."""
    text = re.sub(r"!\[(?:png|svg)\]", "![Picture made by the cell above]", text)
    text = re.sub(r"<style scoped>.*?</style>\n?", "", text, flags=re.DOTALL)
    text = re.sub(r"\n\n((?: {4}[^\n]*\n|\n)+)", _block, text)
    return re.sub(r"(<table.*?</table>)", r'<div class="output">\1</div>', text, flags=re.DOTALL)


def _block(found: re.Match[str]) -> str:
    lines = found[1].strip("\n").split("\n")
    if not any(line.startswith("    ") for line in lines):
        return found[0]
    return "\n\n```text\n" + "\n".join(line.removeprefix("    ") for line in lines) + "\n```\n\n"
