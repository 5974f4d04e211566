"""Size of a program, estimated before it is built."""

from dataclasses import dataclass

from ...instances.errors import UsageError
from ...instances.memory import SHARE, available, fits, readable

BYTES = {"column": 100.0, "row": 90.0, "entry": 80.0}
"""Bytes of memory while a program is built, joined to whole arrays, and copied by a solver; names come on top."""


@dataclass(frozen=True)
class ProgramSize:
    """An estimate, rather too large than too small: ``columns``, ``rows`` and ``entries`` of the matrix, and of all cones.

    ``work`` are bytes that building takes beside the program, such as matrices of all moves.
    """

    columns: float
    rows: float
    entries: float
    work: float = 0.0

    @property
    def bytes(self) -> float:
        """Memory to build the program and to give it to a solver; what a solver adds in its search is not counted."""
        return BYTES["column"] * self.columns + BYTES["row"] * self.rows + BYTES["entry"] * self.entries + self.work

    def __add__(self, other: "ProgramSize") -> "ProgramSize":
        return ProgramSize(
            self.columns + other.columns, self.rows + other.rows, self.entries + other.entries, self.work + other.work
        )  # fmt: skip

    def refuse_beyond_memory(self, form: str) -> None:
        """Raise TooLargeError where there is no memory for it."""
        if not fits(self.bytes):
            raise TooLargeError(
                f"form {form} would have about {_count(self.columns)} columns, {_count(self.rows)} rows and {_count(self.entries)} entries "
                f"and take {readable(self.bytes)} of memory, of which {readable(SHARE * available())} can be had: take a heuristic, or a "
                "solver that needs no form"
            )


class TooLargeError(UsageError):
    """A program that the memory at hand does not hold."""

    code = "too-large"


def _count(number: float) -> str:
    """A number to two digits, as more are not known: ``2,100,000``."""
    digits = max(0, len(str(int(number))) - 2)
    return f"{round(int(number), -digits):,}"
