"""Text of input files: decoding, lines, and numbers that are refused with their line."""

import math
import re
from os import PathLike
from pathlib import Path

from .errors import Code, InputError
from .printable import printable

LARGEST_FILE = 1 << 30
"""Files beyond this many bytes are refused unread."""

# Python's float() and int() also take "nan", "1_000" and digits of other scripts; no file format means those.
_PLAIN = re.compile(r"[0-9eE+\-. \t]*\Z")
_WHOLE = re.compile(r"[+-]?[0-9]{1,18}\Z")


def read_text(path: str | PathLike[str]) -> str:
    """Text of a file without a byte order mark, all line ends as ``\\n``; InputError for a missing, empty or binary one, or no UTF-8."""
    return decode(read_bytes(path), path)


def read_bytes(path: str | PathLike[str]) -> bytes:
    """The bytes of a file; raises InputError for a missing one, a directory, a device, and for more than ``LARGEST_FILE`` bytes."""
    file = Path(path)
    try:
        if file.is_dir():
            raise InputError("is a directory", "file", file=path, expected="a file")
        if not file.exists():
            raise InputError("no such file", "file", file=path)
        if not (file.is_file() or file.is_fifo()):
            raise InputError("is a device", "file", file=path, expected="a file")
        with file.open("rb") as stream:
            data = bytearray()
            while len(data) <= LARGEST_FILE and (block := stream.read(1 << 16)):  # one large read() would allocate its limit
                data += block
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", "file", file=path) from error
    except ValueError as error:  # a NUL in the path
        raise InputError(f"cannot be read: {error}", "file", file=repr(str(path))) from error
    if len(data) > LARGEST_FILE:
        raise InputError("is too large", "too-large", file=path, expected=f"at most {LARGEST_FILE} bytes")
    return bytes(data)


def decode(data: bytes, path: str | PathLike[str] | None = None) -> str:
    """``data`` as text; see ``read_text``."""
    data = data.removeprefix(b"\xef\xbb\xbf")
    if b"\0" in data:
        raise InputError("is not a text file", file=path, line=_line_at(data, data.index(b"\0")), expected="text", found="a NUL byte")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(
            "is not UTF-8", file=path, line=_line_at(data, error.start), expected="UTF-8 text",
            found=f"byte 0x{data[error.start]:02x} at offset {error.start}",
        ) from None  # fmt: skip
    if not text.strip():
        raise InputError("is empty", "missing", file=path, expected="text")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _line_at(data: bytes, offset: int) -> int:
    head = data[:offset].replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return head.count(b"\n") + 1


def lines_of(text: str) -> list[tuple[int, str]]:
    """Numbered lines that are not blank, stripped. Splits at line feeds alone, as editors count lines."""
    return [(k, stripped) for k, line in enumerate(text.split("\n"), start=1) if (stripped := line.strip())]


def shown(token: str) -> str:
    """A token as it may stand in a message: quoted, printable, and not longer than a line."""
    return repr(token if len(token) <= 40 else token[:37] + "...")


def label(text: str) -> str:
    """A name out of a file as it may be printed and stored: on one line, printable, at most 200 characters."""
    kept = " ".join(printable(text, len(text)).split())
    return kept[:200].rstrip() or "unnamed"


def numbers(text: str, line: int, what: str) -> list[float]:
    """Finite numbers of one line, separated by blanks; raises InputError with the first token that is none."""
    if _PLAIN.match(text):
        try:
            values = [float(token) for token in text.split()]
        except ValueError:
            pass
        else:
            if all(map(math.isfinite, values)):
                return values
    bad = next((token for token in text.split() if not is_number(token)), text)
    raise InputError(f"{what} holds something that is no finite number", line=line, expected="a number", found=shown(bad))


def is_number(token: str) -> bool:
    """True if ``token`` is a finite decimal number in ASCII."""
    try:
        return bool(_PLAIN.match(token)) and math.isfinite(float(token))
    except ValueError:
        return False


def number(token: str, line: int, what: str) -> float:
    """One finite number."""
    if not is_number(token.strip()):
        raise InputError(f"{what} must be a finite number", line=line, expected="a number", found=shown(token.strip()))
    return float(token)


def whole(token: str, line: int, what: str, *, least: int) -> int:
    """One whole number of at least ``least`` (at most 18 digits; ``5.0`` is accepted)."""
    token = token.strip()
    text = token[:-2] if token.endswith(".0") else token
    if not _WHOLE.match(text) or int(text) < least:
        code: Code = "out-of-range" if _WHOLE.match(text) else "malformed"
        raise InputError(f"{what} must be a whole number", code, line=line, expected=f"{least} or more", found=shown(token))
    return int(text)


def plain(value: float) -> str:
    """Shortest text that reads back as the same number; whole numbers without a point."""
    value = float(value)
    if value.is_integer() and abs(value) < 1e15 and not (value == 0 and math.copysign(1, value) < 0):
        return str(int(value))
    return repr(value)


_CONSONANT = re.compile(r"eu|one|uni(?!n|m)|us[aei]|util")
"""Beginnings of words that are written with a vowel and spoken with a consonant."""


def an(noun: str) -> str:
    """``noun`` behind its article, by how it is spoken: an orchard, a uniform cost, an mdvrp (letter by letter), a tsp."""
    first = re.split(r"[^a-z]", noun.lower().lstrip("'\""), maxsplit=1)[0]
    if re.search("[aeiouy]", first):
        vowel = first[0] in "aeiou" and not _CONSONANT.match(first)
    else:
        vowel = first[:1] in tuple("fhlmnrsx")
    return f"{'an' if vowel else 'a'} {noun}"
