"""Campaigns that come with waybound."""

from __future__ import annotations

from pathlib import Path

_FOLDER = Path(__file__).parent / "data"


def bundled_campaigns() -> dict[str, Path]:
    """Campaign files by name."""
    return {file.stem: file for file in sorted(_FOLDER.glob("*.toml"))}
