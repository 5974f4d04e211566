"""Text from files and users, made safe to print: nothing in it moves a cursor, colours, hides, reorders or imitates the text around it.

Everything that people read goes through ``printable``: lines and titles of certificates, tables, errors, notes, names out of files.
"""

import re

LONGEST = 2000
"""Characters of one text that are shown."""

LONGEST_LINE = 380
"""Characters of an error or a note."""

# Letters and marks that str.isprintable lets pass though they show nothing, and marks piled up on one letter.
_UNSEEN = re.compile("[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef]")
_MARKS = "[\u0300-\u036f\u0483-\u0489\u1ab0-\u1aff\u1dc0-\u1dff\u20d0-\u20ff\ufe20-\ufe2f]"
_PILED = re.compile(f"({_MARKS}{{2}}){_MARKS}+")


def printable(text: object, most: int = LONGEST) -> str:
    """``text`` on one line, of printable characters only, at most ``most`` of them.

    Control characters, line ends, ANSI and bidirectional overrides, characters without width and lone surrogates become blanks; of a
    text that is too long the beginning and the end are kept.
    """
    try:
        shown = str(text)
    except (ValueError, RecursionError):  # a number of thousands of digits, lists a thousand deep
        shown = f"too large to show: {type(text).__name__}"
    if len(shown) > 2 * most:
        shown = shown[:most] + shown[-most:]
    if not shown.isascii():
        shown = _PILED.sub(r"\1", _UNSEEN.sub(" ", shown))
    if not shown.isprintable():
        shown = "".join(c if c.isprintable() else " " for c in shown)
    if len(shown) > most:
        tail = most // 3
        shown = f"{shown[: most - tail - 5]} ... {shown[len(shown) - tail :]}"
    return shown


def one_line(text: object) -> str:
    """An error or a note: printable, without runs of blanks, at most ``LONGEST_LINE`` characters."""
    shown = printable(text, 4 * LONGEST_LINE)
    return printable(" ".join(shown.split()), LONGEST_LINE)
