"""Downloads of benchmark sets from their public homes, for users who have a network.

Nothing is taken on trust: the transfer must be as long as the server said and match its checksum where one is recorded, no
name inside an archive may lead out of the folder, and every instance must be readable. Only then do the files take their places.
Files of no known format, such as a description, are left out.

The homes below are marked as unverified: whether they still answer, and with what, has not been checked, so no checksums are recorded.
"""

from __future__ import annotations

import gzip
import hashlib
import http.client
import io
import tarfile
import tempfile
import threading
import time
import urllib.error
import urllib.parse
import urllib.request
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path, PurePosixPath

from .errors import InputError, UsageError
from .reading import read_instance

TIMEOUT = 30.0
"""Seconds without an answer or a byte after which a download is given up."""

LONGEST_DOWNLOAD = 1800.0
"""Seconds for one archive, however steadily its bytes drip."""

LARGEST_DOWNLOAD = 256 << 20
LARGEST_CONTENT = 1 << 30
LARGEST_COUNT = 20_000


@dataclass(frozen=True)
class InstanceSet:
    """A set of instances and its home.

    Parameters
    ----------
    name : str
    summary : str
        What it holds.
    base_url : str
        Home of its archives.
    archives : tuple of str
        Names below ``base_url``: zip or tar, or single files; gzip is undone.
    suffixes : tuple of str
        Members that are kept.
    sha256 : tuple of (str or None)
        Checksum of each archive, None where none is known.
    verified : bool
        Whether the home was ever reached from here.
    """

    name: str
    summary: str
    base_url: str
    archives: tuple[str, ...]
    suffixes: tuple[str, ...]
    sha256: tuple[str | None, ...] = ()
    verified: bool = False

    @property
    def status(self) -> str:
        """What is known about the home, for tables and messages."""
        return "verified home" if self.verified else "unverified home"

    def checksum(self, position: int) -> str | None:
        """Checksum of archive number ``position``."""
        return self.sha256[position] if position < len(self.sha256) else None


_SINTEF = "https://www.sintef.no/globalassets/project/top/vrptw/"
_HOMBERGER = [
    InstanceSet(
        f"homberger-{size}", f"Gehring and Homberger, {size} customers (VRPTW)", f"{_SINTEF}homberger/{size}/",
        (f"homberger_{size}_customer_instances.zip",), (".txt",),
    )
    for size in (200, 400, 600, 800, 1000)
]  # fmt: skip
_CVRPLIB = [
    InstanceSet(
        f"cvrplib-{letter.lower()}", f"CVRPLIB set {letter}", "http://vrp.galgos.inf.puc-rio.br/media/com_vrp/instances/",
        (f"Vrp-Set-{letter}.zip",), (".vrp", ".sol"),
    )
    for letter in ("A", "B", "E", "F", "M", "P", "X")
]  # fmt: skip

SETS: dict[str, InstanceSet] = {
    entry.name: entry
    for entry in (
        InstanceSet("solomon", "Solomon, 100 customers (VRPTW)", f"{_SINTEF}solomon/", ("solomon-100.zip",), (".txt",)),
        *_HOMBERGER,
        *_CVRPLIB,
        InstanceSet(
            "pyvrp-instances", "CVRP and VRPTW instances with best-known solutions, kept by PyVRP",
            "https://codeload.github.com/PyVRP/Instances/zip/refs/heads/", ("main",), (".vrp", ".txt", ".sol"),
        ),
        InstanceSet(
            "tsplib", "TSPLIB, symmetric", "http://comopt.ifi.uni-heidelberg.de/software/TSPLIB95/tsp/", ("ALL_tsp.tar.gz",),
            (".tsp", ".tour"),
        ),
    )
}  # fmt: skip


def fetch_set(name: str, folder: str | PathLike[str], base_url: str | None = None) -> list[Path]:
    """Download the set ``name`` into ``folder``; see ``fetch``."""
    if name not in SETS:
        raise UsageError(f"unknown set {name!r}; choose from {', '.join(SETS)}")
    return fetch(SETS[name], folder, base_url)


def fetch(chosen: InstanceSet, folder: str | PathLike[str], base_url: str | None = None) -> list[Path]:
    """Download a set, check it, and put its files into ``folder``.

    Parameters
    ----------
    chosen : InstanceSet
    folder : path-like
        Made if missing. Files of the same names are replaced.
    base_url : str, optional
        Another home that holds the same archives.

    Returns
    -------
    list of Path
        The files, sorted.

    Raises
    ------
    InputError
        If the home cannot be reached, or sends something cut off, altered, unsafe or unreadable. ``folder`` is then as before.
    UsageError
        If ``base_url`` is no http address.
    """
    home = base_url or chosen.base_url
    if urllib.parse.urlsplit(home).scheme not in ("http", "https"):
        raise UsageError(f"{home!r} is no address that begins with http:// or https://")
    target = Path(folder)
    if target.exists() and not target.is_dir():
        raise InputError("is a file, not a folder to put a set into", file=target)
    files: dict[PurePosixPath, bytes] = {}
    for position, archive in enumerate(chosen.archives):
        url = f"{home.rstrip('/')}/{archive}"
        data = _download(url, chosen)
        expected = chosen.checksum(position)
        found = hashlib.sha256(data).hexdigest()
        if expected is not None and found != expected:
            raise InputError("checksum is wrong, nothing was kept", file=url, expected=f"sha256 {expected}", found=found)
        for member, content in _members(data, archive, url):
            if member.suffix.lower() in chosen.suffixes:
                files[member] = content
    placed = _place(files, target, chosen)
    if not placed:
        raise InputError(f"holds no instance in {' or '.join(chosen.suffixes)} files", file=home)
    return placed


def _download(url: str, chosen: InstanceSet) -> bytes:
    """The archive at ``url``; in a thread, because a server can keep name resolution, headers and body waiting for as long as it likes."""
    end = time.monotonic() + LONGEST_DOWNLOAD
    outcome: list[bytes | BaseException] = []

    def go() -> None:
        try:
            outcome.append(_transfer(url, chosen, end))
        except BaseException as error:
            outcome.append(error)

    worker = threading.Thread(target=go, name="waybound-download", daemon=True)
    worker.start()
    worker.join(max(0.0, end - time.monotonic()))
    if not outcome:
        raise _too_slow(url)
    if isinstance(outcome[0], BaseException):
        raise outcome[0]
    return outcome[0]


def _too_slow(url: str) -> InputError:
    return InputError("takes too long, nothing was kept", file=url, expected=f"at most {LONGEST_DOWNLOAD:g} s")


def _transfer(url: str, chosen: InstanceSet, end: float) -> bytes:
    opener = urllib.request.OpenerDirector()
    for handler in (
        urllib.request.ProxyHandler(), urllib.request.HTTPHandler(), urllib.request.HTTPSHandler(), urllib.request.HTTPRedirectHandler(),
        urllib.request.HTTPDefaultErrorHandler(), urllib.request.HTTPErrorProcessor(), urllib.request.UnknownHandler(),
    ):  # fmt: skip
        opener.add_handler(handler)  # the default opener would follow a redirect to ftp as well
    request = urllib.request.Request(url, headers={"User-Agent": "waybound"})
    hint = f"the {chosen.status} of {chosen.name}; with another copy, name its address as base URL, or read files you have"
    try:
        with opener.open(request, timeout=TIMEOUT) as reply:
            length = reply.headers.get("Content-Length")
            data = bytearray()
            while block := reply.read1(1 << 16):  # read() would wait for all of them
                data += block
                if time.monotonic() > end:
                    raise _too_slow(url)
                if len(data) > LARGEST_DOWNLOAD:
                    raise InputError("is too large", file=url, expected=f"at most {LARGEST_DOWNLOAD} bytes")
    except urllib.error.HTTPError as error:
        error.close()
        raise InputError(f"cannot be downloaded: the server answers {error.code} {error.reason} ({hint})", file=url) from None
    except (urllib.error.URLError, OSError, http.client.HTTPException, ValueError) as error:
        reason = getattr(error, "reason", None) or error
        raise InputError(f"cannot be downloaded: {reason or type(error).__name__} ({hint})", file=url) from None
    if length is not None and length.isdigit() and len(data) != int(length):
        raise InputError("transfer was cut off, nothing was kept", file=url, expected=f"{length} bytes", found=f"{len(data)} bytes")
    return bytes(data)


def _members(data: bytes, name: str, url: str) -> Iterator[tuple[PurePosixPath, bytes]]:
    """Files of an archive by name and content; ``data`` itself if it is none."""
    try:
        if zipfile.is_zipfile(io.BytesIO(data)):
            yield from _zip_members(data, url)
            return
        if data[:2] == b"\x1f\x8b":
            data, name = _gunzip(data), name.removesuffix(".gz")
        if (len(data) > 262 and data[257:262] == b"ustar") or name.endswith((".tar", ".tgz")):
            yield from _tar_members(data, url)
            return
    except (zipfile.BadZipFile, tarfile.TarError, zlib.error, EOFError, OSError, RuntimeError, NotImplementedError) as error:
        raise InputError(f"archive is damaged: {error}", file=url) from None
    yield _safe(name, url), data


def _zip_members(data: bytes, url: str) -> Iterator[tuple[PurePosixPath, bytes]]:
    total = 0
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        entries = [entry for entry in archive.infolist() if not entry.is_dir()]
        for number, entry in enumerate(entries):
            total += entry.file_size
            _bounded(total, number, url)
            path = _safe(entry.filename, url)
            if entry.external_attr >> 16 & 0o170000 == 0o120000:
                raise InputError(f"archive holds a link: {entry.filename[:80]!r}", file=url)
            yield path, archive.read(entry)  # raises if the content is longer than its entry says, or its CRC is wrong


def _tar_members(data: bytes, url: str) -> Iterator[tuple[PurePosixPath, bytes]]:
    total = 0
    with tarfile.open(fileobj=io.BytesIO(data), mode="r:*") as archive:
        for number, entry in enumerate(archive):
            if entry.isdir():
                continue
            total += entry.size
            _bounded(total, number, url)
            path = _safe(entry.name, url)
            stream = archive.extractfile(entry) if entry.isreg() else None
            if stream is None:
                raise InputError(f"archive holds something that is no file: {entry.name[:80]!r}", file=url)
            content = stream.read()
            if path.suffix == ".gz":
                content, path = _gunzip(content), path.with_suffix("")
                total += len(content)
            yield path, content


def _gunzip(data: bytes) -> bytes:
    with gzip.GzipFile(fileobj=io.BytesIO(data)) as stream:
        content = stream.read(LARGEST_CONTENT + 1)
    if len(content) > LARGEST_CONTENT:
        raise OSError(f"it unpacks to more than {LARGEST_CONTENT} bytes")
    return content


def _bounded(total: int, number: int, url: str) -> None:
    if total > LARGEST_CONTENT or number > LARGEST_COUNT:
        raise InputError("archive is too large", file=url, expected=f"at most {LARGEST_CONTENT} bytes in {LARGEST_COUNT} files")


def _safe(name: str, url: str) -> PurePosixPath:
    """A member's path, if it stays below the folder it is unpacked in."""
    path = PurePosixPath(name)
    bad = path.is_absolute() or ".." in path.parts or "\\" in name or ":" in name or not name.isprintable() or not path.parts
    if bad:
        raise InputError(f"archive holds an unsafe name, nothing was kept: {name[:80]!r}", file=url)
    return path


def _place(files: dict[PurePosixPath, bytes], target: Path, chosen: InstanceSet) -> list[Path]:
    """Write everything beside its place, read it there, and only then move it."""
    placed: list[Path] = []
    made = not target.exists()
    try:
        target.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".fetch-", dir=target) as scratch:
            kept = []
            for path, content in files.items():
                file = Path(scratch, *path.parts)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content)
                if _is_instance(file, path, chosen):
                    kept.append(path)
            for path in kept:
                _refuse_way_out(target, path)
            for path in kept:
                final = target.joinpath(*path.parts)
                final.parent.mkdir(parents=True, exist_ok=True)
                Path(scratch, *path.parts).replace(final)
                placed.append(final)
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror or error}", file=target) from error
    finally:
        if made and not placed and target.is_dir() and not any(target.iterdir()):
            target.rmdir()
    return sorted(placed)


def _refuse_way_out(target: Path, path: PurePosixPath) -> None:
    """Raise InputError if a link below ``target`` would lead a file out of it."""
    if not target.joinpath(*path.parent.parts).resolve().is_relative_to(target.resolve()):
        raise InputError("would be written through a link that leads out of the folder, nothing was kept", file=target / path)


def _is_instance(file: Path, path: PurePosixPath, chosen: InstanceSet) -> bool:
    """Whether a file is kept: solutions, and instances that can be read or belong to a problem that is not supported."""
    if path.suffix.lower() in (".sol", ".tour"):
        return True
    try:
        read_instance(file)
    except InputError as error:
        if "no known format" in error.message:
            return False
        if "not supported" not in error.message:
            raise InputError(
                f"{chosen.name} holds a file that cannot be read, nothing was kept: {error.message}", file=path, line=error.line,
                expected=error.expected, found=error.found,
            ) from None  # fmt: skip
    return True
