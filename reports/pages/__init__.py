"""Pages: reports as one HTML file each, without a network. ``page.Page`` is made of the blocks of ``blocks``; nobody else writes HTML."""

from ... import _guard as _guard
