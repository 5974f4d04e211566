"""Pages that mkdocs gets beside ``docs``: made from registries, the reference of the API, the gallery and the executed notebooks."""

import re
from typing import Any

import api_pages
import command_line_page
import formats_page
import gallery_page
import guarantees_page
import notebook_pages
import variants_page
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

PAGES = {
    "command-line": command_line_page.page,
    "formats": formats_page.page,
    "guarantees": guarantees_page.page,
    "variants": variants_page.page,
}


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add what is made."""
    made: dict[str, str | bytes] = {f"generated/{name}.md": page() for name, page in PAGES.items()}
    made |= {f"reference/{name}.md": text for name, text in api_pages.pages().items()}
    executed = bool(config.extra.get("execute_notebooks", True))
    made["generated/gallery.md"], pictures = gallery_page.page(executed=executed)
    made |= {f"generated/gallery/{name}": data for name, data in pictures.items()}
    for script in notebook_pages.notebooks():
        one = notebook_pages.page(script, executed=executed)
        made |= {f"notebooks/{name}": data for name, data in one.pictures.items()}
        made |= {f"notebooks/{script.stem}.md": one.text, f"notebooks/{script.stem}.ipynb": one.notebook}
    for name, content in made.items():
        files.append(File.generated(config, name, content=content))
    return files


def on_page_content(html: str, **_: Any) -> str:
    """Mark names in code, which no line is broken within: a phone would break them at their hyphens."""
    return NAME.sub(r'<code class="name">', html)


NAME = re.compile(r"<code>(?=[^<\s]{1,32}</code>)")
