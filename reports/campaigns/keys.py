"""Tables of a campaign file: keys that exist, values of the kinds that they take, and otherwise one line that says what is wrong."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from ...instances.errors import Code, InputError
from ...instances.suggestions import did_you_mean
from ...instances.text import shown


class Keys:
    """One table of a campaign file, which may have the keys ``known`` and no others.

    ``where`` is the table in words, "" for the top of the file. Raises InputError for another key, with the nearest one that there is.
    """

    def __init__(self, table: Mapping[str, Any], file: Path, where: str, known: Collection[str]) -> None:
        self.table, self.file, self.where = table, file, where
        for key in table:
            if key not in known:
                hint = did_you_mean(key, known) or f"; there are {', '.join(known)}"
                raise self.fault(f"unknown key {key!r}{self._of()}{hint}", "unknown-name")

    def __contains__(self, key: str) -> bool:
        return key in self.table

    def text(self, key: str, default: str | None = None) -> str | None:
        """A text that is not empty."""
        value = self.table.get(key, default)
        if value is not None and (not isinstance(value, str) or not value.strip()):
            raise self.expected(key, "a text", value)
        return value

    def texts(self, key: str) -> list[str | None]:
        """A text or a list of them; where the key is missing one None."""
        value = self.table.get(key)
        if isinstance(value, list):
            if not value or not all(isinstance(one, str) and one.strip() for one in value):
                raise self.expected(key, "a text or a list of texts", value)
            return list(value)
        return [self.text(key)]

    def truth(self, key: str, default: bool = False) -> bool:
        """True or false."""
        value = self.table.get(key, default)
        if not isinstance(value, bool):
            raise self.expected(key, "true or false", value)
        return value

    def entries(self, key: str, name: str) -> list[dict[str, Any]]:
        """A list of names and tables, each as a table with the key ``name``."""
        value = self.table.get(key, [])
        if not isinstance(value, list) or not all(isinstance(one, dict) or (isinstance(one, str) and one.strip()) for one in value):
            raise self.expected(key, "a list of names or tables", value)
        return [{name: one} if isinstance(one, str) else one for one in value]

    def numbers(self, key: str, default: list[int]) -> list[int]:
        """A list of whole numbers, each once."""
        value = self.table.get(key, default)
        if not isinstance(value, list) or not value or not all(isinstance(one, int) and not isinstance(one, bool) for one in value):
            raise self.expected(key, "a list of whole numbers", value)
        if len(set(value)) < len(value):
            twice = next(one for one in value if value.count(one) > 1)
            raise self.fault(f"{key}{self._of()} names {twice} twice", "duplicate")
        return value

    def inner(self, key: str) -> dict[str, Any]:
        """A table, empty where there is none."""
        value = self.table.get(key, {})
        if not isinstance(value, dict):
            raise self.expected(key, "a table", value)
        return value

    def fault(self, message: str, code: Code = "malformed") -> InputError:
        """An error in this file."""
        return InputError(message, code, file=self.file)

    def expected(self, key: str, kind: str, found: Any) -> InputError:
        """An error for a value of another kind."""
        return InputError(f"{key}{self._of()}", file=self.file, expected=kind, found=shown(repr(found)))

    def _of(self) -> str:
        return f" of {self.where}" if self.where else ""
