"""Certificates as files: JSON, with evidence that is large in a compressed file beside it, named there with its SHA-256."""

import gzip
import hashlib
import json
import zlib
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..instances.atomic import atomic_file, atomic_write
from ..instances.document import parse_json
from ..instances.errors import CheckFailedError, InputError
from ..instances.printable import printable
from ..instances.text import decode, read_bytes, read_text
from .json_text import finite, json_text

if TYPE_CHECKING:
    from .certificate import Certificate

LARGE = 1 << 16
"""Characters of evidence beyond which it stands in a file of its own."""

MOST_BYTES = 1 << 28
"""Largest evidence that is unpacked from a compressed file; reading stops where there is more."""

SUFFIX = ".evidence.json.gz"


def write_certificate(certificate: "Certificate", path: str | PathLike[str]) -> None:
    """Write a certificate with its evidence to ``path``: both files, whole, or neither.

    Raises InputError if a file cannot be written.
    """
    data = certificate.to_json(with_evidence=True)
    evidence = json.dumps(finite(data["evidence"]), allow_nan=False)
    target = Path(path)
    if len(evidence) <= LARGE or (target.exists() and not target.is_file()):  # nothing stands beside a pipe
        atomic_write(target, json_text(data))
        return
    target = target.resolve()  # beside the file itself, whatever link leads to it
    beside, packed = target.with_suffix(SUFFIX), gzip.compress(evidence.encode(), mtime=0)
    named = {"file": beside.name, "sha256": hashlib.sha256(packed).hexdigest()}
    with atomic_file(beside) as stream:
        stream.write(packed)
        atomic_write(target, json_text({**data, "evidence": named}))


def read_certificate(path: str | PathLike[str]) -> Mapping[str, Any]:
    """The object in a certificate file, with the evidence that it names in place.

    Raises InputError if a file is missing or malformed, or evidence is larger than ``MOST_BYTES`` once it is unpacked. Raises
    CheckFailedError if the evidence is not what the certificate was written with.
    """
    text = read_text(path)
    try:
        data = parse_json(text)
        if not isinstance(data, Mapping):
            raise InputError("is no certificate", expected="a JSON object")
        if not isinstance(data.get("evidence"), Mapping):
            return data
        name, known = (data["evidence"].get(key) for key in ("file", "sha256"))
        if not isinstance(name, str) or not isinstance(known, str) or Path(name).name != name or not name.endswith(SUFFIX):
            expected = f'a list, or the name of a file beside it, "...{SUFFIX}", and its sha256'
            raise InputError("the certificate's evidence is malformed", expected=expected, found=printable(str(data["evidence"]), 80))
    except InputError as error:
        raise error.at(file=path) from None
    beside = Path(path).resolve().parent / name
    packed = read_bytes(beside)
    if hashlib.sha256(packed).hexdigest() != known:
        raise CheckFailedError(f"{beside}: is not the evidence that {path} was written with: its SHA-256 differs")
    try:
        return {**data, "evidence": parse_json(decode(_unpacked(packed)))}
    except InputError as error:
        raise error.at(file=beside) from None


def _unpacked(packed: bytes) -> bytes:
    reader = zlib.decompressobj(wbits=31)
    try:
        data = reader.decompress(packed, MOST_BYTES + 1)
    except zlib.error as error:
        raise InputError(f"is no gzip file: {error}") from None
    if len(data) > MOST_BYTES:
        raise InputError("is too large once it is unpacked", "too-large", expected=f"at most {MOST_BYTES} bytes")
    if not reader.eof or reader.unused_data:
        raise InputError("is no gzip file", found="an end before the end" if not reader.eof else "something after its end")
    return data
