"""Notebooks are executed and told as Markdown: pictures beside the page, tables in blocks of their own, and nothing on standard error."""

import json
from pathlib import Path

import pytest

pytest.importorskip("nbclient", reason="needs the extra docs")
pytest.importorskip("jupytext", reason="needs the extra docs")

import notebook_pages

SCRIPT = """# %% [markdown]
# # A title
#
# Words.

# %%
import pandas as pd

pd.DataFrame({"a": ["<b>"]})

# %%
print("one")
print("two")

# %%
3 * 4

# %%
import matplotlib.pyplot as plt

_ = plt.plot([1, 2])
"""


@pytest.fixture
def script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(notebook_pages, "FOLDER", tmp_path)
    (tmp_path / "small.py").write_text(SCRIPT)
    return tmp_path / "small.py"


def test_without_execution_a_page_has_text_and_code_alone(script: Path) -> None:
    page = notebook_pages.page(script, executed=False)
    assert page.text.startswith("# A title\n\n*A notebook: [open it in Jupyter](small.ipynb){ download }")
    assert page.text.count("```python") == 4
    assert (page.pictures, page.text.count("```text")) == ({}, 0)
    assert [cell["cell_type"] for cell in json.loads(page.notebook)["cells"]] == ["markdown", *["code"] * 4]


@pytest.mark.slow
def test_executed_a_page_has_tables_texts_and_pictures(script: Path) -> None:
    page = notebook_pages.page(script)
    assert '<div class="output">' in page.text and "&lt;b&gt;" in page.text
    assert "```text\none\ntwo\n```" in page.text and "```text\n12\n```" in page.text
    ((name, data),) = page.pictures.items()
    assert f"![Picture made by the cell above]({name})" in page.text
    assert data.startswith(b"\x89PNG")


@pytest.mark.slow
@pytest.mark.parametrize("cell", ["import warnings\nwarnings.warn('old')", "import sys\nprint('lost', file=sys.stderr)"])
def test_a_notebook_that_warns_is_refused(script: Path, cell: str) -> None:
    script.write_text(f"{SCRIPT}\n# %%\n{cell}\n")
    with pytest.raises(RuntimeError, match=r"small\.py writes to standard error: .*(old|lost)"):
        notebook_pages.page(script)


@pytest.mark.slow
def test_a_notebook_that_fails_ends_the_build(script: Path) -> None:
    script.write_text(f"{SCRIPT}\n# %%\n1 / 0\n")
    with pytest.raises(Exception, match="ZeroDivisionError"):
        notebook_pages.page(script)
