"""Figures of matplotlib as SVG within a page."""

import colorsys
import io
import re
from typing import TYPE_CHECKING, Any

from .rendering import Rendering

if TYPE_CHECKING:
    from markupsafe import Markup


_TAG = re.compile(r"<[^>]*>")
_IDS = re.compile(r'( id="|href="#|url\(#)')
_COLOUR = re.compile(r"(?<=: )#([0-9a-f]{6})\b")
_HEAD = re.compile(r"<svg [^>]*?viewBox=\"0 0 ([\d.]+) ([\d.]+)\"[^>]*>")

DARK_GROUND = 0.012
"""Relative luminance of the dark page."""

LEAST_CONTRAST = 4.5
"""Least contrast of lines and text on dark ground (Web Content Accessibility Guidelines 2.2, criterion 1.4.3)."""


def figure_svg(drawn: Any, made: Rendering) -> "tuple[Markup, float, bool]":
    """The figure of matplotlib axes, or a figure, as an SVG element, its width in CSS pixels, and whether it needs white ground.

    Text stays text, and ids are unique on the page. Colours refer to variables of the page, so that they turn with its ground, but for
    colours that stand for numbers: their meaning would change.
    """
    from markupsafe import Markup
    from matplotlib import rc_context

    figure = getattr(drawn, "figure", drawn)
    scale = any(getattr(part, "get_array", lambda: None)() is not None for part in figure.findobj())
    file = io.BytesIO()
    name = made.name("f")
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "waybound"}):
        figure.savefig(file, format="svg", transparent=True, metadata={"Date": None})
    text = file.getvalue().decode("utf-8")
    head = _HEAD.search(text)
    assert head is not None, "matplotlib writes a viewBox"
    width, height = float(head[1]), float(head[2])
    body = re.sub(r"<metadata>.*?</metadata>", "", text[head.end() :], flags=re.DOTALL)
    turned: set[str] = set()

    def within(tag: re.Match[str]) -> str:
        made = _IDS.sub(rf"\g<1>{name}-", tag[0])
        turned.update(_COLOUR.findall(made))
        return made if scale else _COLOUR.sub(r"var(--c\1)", made)

    body = _TAG.sub(within, body)
    if not scale:
        made.colours |= turned
    pixels = width * 96.0 / 72.0
    return Markup(f'<svg viewBox="0 0 {width:g} {height:g}" aria-hidden="true">{body.strip()}'), pixels, scale  # matplotlib escapes


def dark_colour(colour: str) -> str:
    """The counterpart of ``rrggbb`` on dark ground: greys are mirrored, other colours made light enough to be told from it."""
    rgb = [int(colour[k : k + 2], 16) / 255.0 for k in (0, 2, 4)]
    hue, light, full = colorsys.rgb_to_hls(*rgb)
    if max(rgb) - min(rgb) < 0.04:
        return _hex([0.93 - 0.82 * light] * 3)
    while (_luminance(rgb) + 0.05) / (DARK_GROUND + 0.05) < LEAST_CONTRAST and light < 0.9:
        light += 0.02
        rgb = list(colorsys.hls_to_rgb(hue, light, min(full, 0.75)))
    return _hex(rgb)


def _luminance(rgb: list[float]) -> float:
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in rgb]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _hex(rgb: list[float]) -> str:
    return "".join(f"{round(255.0 * min(max(c, 0.0), 1.0)):02x}" for c in rgb)
