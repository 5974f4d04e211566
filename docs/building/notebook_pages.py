"""Notebooks: percent scripts of ``reports/notebooks``, executed and told as Markdown with their pictures."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jupytext
from nbclient import NotebookClient
from nbconvert import MarkdownExporter

FOLDER = Path(__file__).resolve().parents[2] / "reports" / "notebooks"

TEMPLATE = """
{%- extends 'markdown/index.md.j2' -%}
{%- block stream %}
```text
{{ output.text | trim }}
```
{% endblock stream -%}
{%- block data_text %}
```text
{{ output.data['text/plain'] | trim }}
```
{% endblock data_text -%}
{%- block data_html %}
<div class="output">
{{ output.data['text/html'] | trim }}
</div>
{% endblock data_html -%}
{%- block data_png %}
![Picture made by the cell above]({{ output.metadata.filenames['image/png'].split('/')[-1] }})
{% endblock data_png -%}
"""
"""Outputs in blocks that a site can style, and pictures beside the page."""

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
    quiet = ["--log-level=40"]  # of the kernel itself, about its own sockets
    NotebookClient(notebook, timeout=TIMEOUT, resources={"metadata": {"path": str(FOLDER)}}, extra_arguments=quiet).execute()
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            if output.get("name") == "stderr":
                raise RuntimeError(f"{script.name} writes to standard error: {output['text'].strip()}")
    return notebook


def page(script: Path, *, executed: bool = True) -> NotebookPage:
    """The page of a notebook; with ``executed=False`` its text and code alone."""
    notebook = execute(script) if executed else jupytext.read(script)
    notebook.metadata["language_info"] = {"name": "python"}
    exporter = MarkdownExporter(raw_template=TEMPLATE)
    exporter.exclude_input_prompt = exporter.exclude_output_prompt = True
    text, resources = exporter.from_notebook_node(notebook, resources={"unique_key": script.stem})
    pictures = {Path(name).name: data for name, data in (resources.get("outputs") or {}).items()}
    note = f"*A notebook: [open it in Jupyter]({script.stem}.ipynb){{ download }}. Its script is `reports/notebooks/{script.name}`.*"
    title, _, rest = text.lstrip().partition("\n")
    return NotebookPage(f"{title}\n\n{note}\n{rest}", pictures, jupytext.writes(notebook, fmt="ipynb"))
