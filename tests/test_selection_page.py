"""What the page on selection shows is true."""

import re
from pathlib import Path

from waybound.heuristics.heuristic import HEURISTICS

PAGE = (Path(__file__).resolve().parent.parent / "docs" / "selection.md").read_text(encoding="utf-8")


def test_its_code_runs() -> None:
    blocks = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    assert len(blocks) == 4
    namespace: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "docs/selection.md", "exec"), namespace)


def test_its_table_names_every_method_and_its_options() -> None:
    rows = dict(re.findall(r"^\| `([a-z-]+)` \|.*\|([^|]*)\|$", PAGE, flags=re.MULTILINE))
    offered = {name for name in HEURISTICS if "selection" in HEURISTICS[name].families}
    assert offered <= set(rows)
    for name in offered:
        assert set(re.findall(r"`([a-z]+)`", rows[name])) == set(HEURISTICS[name].parameters())
