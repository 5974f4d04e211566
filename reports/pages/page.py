"""A page: one HTML file that needs no network, is readable on a phone, and is light or dark as the reader's system is."""

import base64
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike

from ... import _version
from ...instances.atomic import atomic_write
from ...instances.printable import printable
from .figures import dark_colour
from .rendering import Block, Rendering, asset


@dataclass(frozen=True, eq=False)
class Page:
    """A title, a sentence or two that lead in, and blocks.

    Parameters
    ----------
    blocks : sequence of Block
        Of ``waybound.reports.pages.blocks``, or anything with their method ``html``.
    """

    title: str
    lead: str
    blocks: Sequence[Block]

    def html(self) -> str:
        """The whole document."""
        rendering = Rendering()
        inside = rendering.blocks(self.blocks)
        colours = {colour: dark_colour(colour) for colour in sorted(rendering.colours)}
        script = "\n".join(asset(name) for name in rendering.scripts)
        digest = base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")
        filled = rendering.template(
            "page.html", title=printable(self.title), lead=printable(self.lead), inside=inside, colours=colours, style=asset("page.css"),
            script=script, digest=digest, version=_version.__version__,
        )  # fmt: skip
        return str(filled)

    def write(self, path: str | PathLike[str]) -> None:
        """Write the page, whole or not at all. Raises InputError where it cannot be written."""
        atomic_write(path, self.html())
