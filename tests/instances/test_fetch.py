"""Downloads, against a server on the loopback address."""

from __future__ import annotations

import gzip
import hashlib
import io
import socket
import tarfile
import threading
import time
import zipfile
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

from waybound.instances import fetch as f
from waybound.instances.bundled import bundled_path
from waybound.instances.errors import InputError, UsageError

C25 = bundled_path("demo-c25").read_bytes()
X40 = bundled_path("demo-x40").read_bytes()
Reply = Callable[[BaseHTTPRequestHandler], None]


@pytest.fixture
def serve(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., str]]:
    """Starts a server with the given replies by path, and returns its address."""
    for name in ("http_proxy", "HTTP_PROXY", "https_proxy", "HTTPS_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    servers = []

    def start(replies: dict[str, bytes | Reply]) -> str:
        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                reply = replies.get(self.path)
                if reply is None:
                    self.send_error(404)
                elif callable(reply):
                    reply(self)
                else:
                    self.send_response(200)
                    self.send_header("Content-Length", str(len(reply)))
                    self.end_headers()
                    self.wfile.write(reply)

            def log_message(self, *_: Any) -> None:
                pass

        server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        servers.append(server)
        return f"http://127.0.0.1:{server.server_port}/sets"

    yield start
    for server in servers:
        server.shutdown()
        server.server_close()


def zipped(files: dict[str, bytes], link: str = "") -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
        if link:
            entry = zipfile.ZipInfo(link)
            entry.external_attr = 0o120777 << 16
            archive.writestr(entry, "/etc/passwd")
    return out.getvalue()


def tarred(files: dict[str, bytes], link: str = "", mode: str = "w:gz") -> bytes:
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode=mode) as archive:  # type: ignore[call-overload]
        for name, content in files.items():
            entry = tarfile.TarInfo(name)
            entry.size = len(content)
            archive.addfile(entry, io.BytesIO(content))
        if link:
            entry = tarfile.TarInfo(link)
            entry.type, entry.linkname = tarfile.SYMTYPE, "/etc/passwd"
            archive.addfile(entry)
    return out.getvalue()


def a_set(archive: str = "a.zip", sha256: str | None = None) -> f.InstanceSet:
    return f.InstanceSet("demo", "two demos", "http://127.0.0.1:1/", (archive,), (".txt", ".vrp", ".sol"), (sha256,))


GOOD = {"In/c25.txt": C25, "In/x40.vrp": X40, "x40.sol": b"Route #1: 1\n", "README.txt": b"Hello\n", "logo.png": b"\x89PNG"}


@pytest.mark.parametrize(
    ("name", "data"), [("a.zip", zipped(GOOD)), ("a.tar.gz", tarred(GOOD)), ("a.tgz", tarred(GOOD)), ("a.tar", tarred(GOOD, mode="w"))]
)
def test_an_archive_is_unpacked_and_what_is_no_instance_left_out(name: str, data: bytes, serve: Any, tmp_path: Path) -> None:
    home = serve({f"/sets/{name}": data})
    folder = tmp_path / "new" / "folder"
    files = f.fetch(a_set(name, hashlib.sha256(data).hexdigest()), folder, home)
    assert [p.relative_to(folder).as_posix() for p in files] == ["In/c25.txt", "In/x40.vrp", "x40.sol"]
    assert files[0].read_bytes() == C25
    assert sorted(p.name for p in folder.rglob("*") if p.is_file()) == ["c25.txt", "x40.sol", "x40.vrp"]


def test_single_files_and_gzipped_members_are_unpacked(serve: Any, tmp_path: Path) -> None:
    home = serve(
        {"/sets/c25.txt": C25, "/sets/x40.vrp.gz": gzip.compress(X40), "/sets/all.tar.gz": tarred({"y/x.vrp.gz": gzip.compress(X40)})}
    )
    for archive, expected in (("c25.txt", "c25.txt"), ("x40.vrp.gz", "x40.vrp"), ("all.tar.gz", "x.vrp")):
        assert [p.name for p in f.fetch(a_set(archive), tmp_path / archive, home)] == [expected]


def test_files_of_the_same_name_are_replaced_and_others_stay(serve: Any, tmp_path: Path) -> None:
    (tmp_path / "c25.txt").write_text("old")
    (tmp_path / "mine.txt").write_text("mine")
    f.fetch(a_set("c25.txt"), tmp_path, serve({"/sets/c25.txt": C25}))
    assert (tmp_path / "c25.txt").read_bytes() == C25
    assert (tmp_path / "mine.txt").read_text() == "mine"


def cut_off(handler: BaseHTTPRequestHandler) -> None:
    handler.send_response(200)
    handler.send_header("Content-Length", str(len(C25)))
    handler.end_headers()
    handler.wfile.write(C25[:1000])


def elsewhere(handler: BaseHTTPRequestHandler) -> None:
    handler.send_response(302)
    handler.send_header("Location", "ftp://127.0.0.1/c25.txt")
    handler.end_headers()


def nonsense(handler: BaseHTTPRequestHandler) -> None:
    handler.wfile.write(b"hello, I am no web server\r\n\r\n")


DAMAGED = bytearray(zipped({"a.txt": C25}))
DAMAGED[60] ^= 0xFF


@pytest.mark.parametrize(
    ("archive", "reply", "message"),
    [
        ("c25.txt", None, "the server answers 404"),
        ("c25.txt", cut_off, "transfer was cut off, nothing was kept; expected 2522 bytes; found 1000 bytes|IncompleteRead"),
        ("c25.txt", elsewhere, "cannot be downloaded"),
        ("c25.txt", nonsense, "cannot be downloaded"),
        ("c25.txt", C25[:700], "holds a file that cannot be read, nothing was kept"),
        ("a.zip", zipped({"a.txt": C25})[:-30], "is not|holds|damaged|no instance"),
        ("a.zip", bytes(DAMAGED), "archive is damaged"),
        ("a.tar.gz", tarred({"a.txt": C25})[:-200], "archive is damaged"),
        ("a.tar.gz", b"\x1f\x8bnot gzip at all", "archive is damaged"),
        ("a.zip", zipped({"../evil.txt": C25}), "archive holds an unsafe name, nothing was kept: '../evil.txt'"),
        ("a.zip", zipped({"/etc/evil.txt": C25}), "unsafe name"),
        ("a.zip", zipped({"a/../../evil.txt": C25}), "unsafe name"),
        ("a.zip", zipped({"C:evil.txt": C25}), "unsafe name"),
        ("a.zip", zipped({"good.txt": C25, "..\\evil.txt": C25}), "unsafe name"),
        ("a.zip", zipped({"good.txt": C25}, link="link.txt"), "archive holds a link: 'link.txt'"),
        ("a.tar.gz", tarred({"../evil.txt": C25}), "unsafe name"),
        ("a.tar.gz", tarred({"good.txt": C25}, link="link.txt"), "something that is no file: 'link.txt'"),
        ("a.zip", zipped({"readme.md": b"x"}), "holds no instance in .txt or .vrp or .sol files"),
        ("a.zip", zipped({"readme.txt": b"x"}), "holds no instance"),
    ],
)
def test_what_is_missing_cut_off_altered_or_unsafe_leaves_nothing_behind(
    archive: str, reply: bytes | Reply | None, message: str, serve: Any, tmp_path: Path
) -> None:
    home = serve({} if reply is None else {f"/sets/{archive}": reply})
    folder = tmp_path / "folder"
    with pytest.raises(InputError) as caught:
        f.fetch(a_set(archive), folder, home)
    assert any(part in str(caught.value) for part in message.split("|")), str(caught.value)
    assert "\n" not in str(caught.value)
    assert not folder.exists()
    assert list(tmp_path.iterdir()) == []


def test_a_wrong_checksum_is_refused_with_both(serve: Any, tmp_path: Path) -> None:
    home = serve({"/sets/c25.txt": C25})
    with pytest.raises(
        InputError, match=f"checksum is wrong, nothing was kept; expected sha256 {'0' * 64}; found {hashlib.sha256(C25).hexdigest()}"
    ):
        f.fetch(a_set("c25.txt", "0" * 64), tmp_path / "folder", home)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_download_leaves_an_existing_folder_as_it_was(serve: Any, tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(InputError):
        f.fetch(a_set(), tmp_path, serve({"/sets/a.zip": zipped({"a.txt": C25, "b.txt": C25[:700]})}))
    assert (tmp_path / "a.txt").read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_offline_the_error_names_address_status_and_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("no_proxy", "*")
    with socket.socket() as free:  # bound but not listening: a refused connection
        free.bind(("127.0.0.1", 0))
        home = f"http://127.0.0.1:{free.getsockname()[1]}"
        with pytest.raises(InputError) as caught:
            f.fetch_set("solomon", tmp_path / "folder", home)
    text = str(caught.value)
    assert text.startswith(f"{home}/solomon-100.zip: cannot be downloaded: ")
    assert "unverified home of solomon" in text
    assert caught.value.exit_code == 2
    assert list(tmp_path.iterdir()) == []


def test_bounds_hold(serve: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home = serve({"/sets/a.zip": zipped({"a.txt": C25}), "/sets/x.vrp.gz": gzip.compress(X40)})
    monkeypatch.setattr(f, "LARGEST_CONTENT", 500)
    with pytest.raises(InputError, match="archive is too large; expected at most 500 bytes"):
        f.fetch(a_set(), tmp_path, home)
    with pytest.raises(InputError, match="archive is damaged: it unpacks to more than 500 bytes"):
        f.fetch(a_set("x.vrp.gz"), tmp_path, home)
    monkeypatch.setattr(f, "LARGEST_DOWNLOAD", 100)
    with pytest.raises(InputError, match="is too large; expected at most 100 bytes"):
        f.fetch(a_set(), tmp_path, home)
    assert list(tmp_path.iterdir()) == []


def test_a_drip_of_bytes_is_given_up(serve: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f, "LONGEST_DOWNLOAD", 0.4)
    ended = threading.Event()

    def drip(handler: BaseHTTPRequestHandler, *, head: bool) -> None:
        if head:
            handler.send_response(200)
            handler.end_headers()
        while not ended.wait(0.05):
            try:
                handler.wfile.write(b"x")
            except OSError:
                return

    try:
        for head in (True, False):
            home = serve({"/sets/a.zip": lambda handler, head=head: drip(handler, head=head)})
            began = time.perf_counter()
            with pytest.raises(InputError, match=r"takes too long, nothing was kept; expected at most 0.4 s"):
                f.fetch(a_set(), tmp_path / "folder", home)
            assert time.perf_counter() - began < 2.0
    finally:
        ended.set()
    assert list(tmp_path.iterdir()) == []


def test_no_link_below_the_folder_leads_a_file_out_of_it(serve: Any, tmp_path: Path) -> None:
    folder, outside = tmp_path / "folder", tmp_path / "outside"
    folder.mkdir()
    outside.mkdir()
    (folder / "In").symlink_to(outside)
    with pytest.raises(InputError, match="leads out of the folder, nothing was kept"):
        f.fetch(a_set(), folder, serve({"/sets/a.zip": zipped({"a.txt": C25, "In/deep/b.txt": C25})}))
    assert list(outside.iterdir()) == []
    assert [p.name for p in folder.iterdir()] == ["In"]
    (folder / "In").unlink()
    (folder / "In").symlink_to(folder)  # inside it a link may lead where it likes
    (folder / "a.txt").symlink_to(outside / "kept")
    f.fetch(a_set(), folder, serve({"/sets/a.zip": zipped({"a.txt": C25})}))
    assert not (folder / "a.txt").is_symlink() and list(outside.iterdir()) == []


def test_usage_errors_come_before_any_connection(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="unknown set 'nothing'; choose from solomon"):
        f.fetch_set("nothing", tmp_path)
    with pytest.raises(UsageError, match="no address that begins with http"):
        f.fetch_set("solomon", tmp_path, "file:///etc")
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="is a file, not a folder"):
        f.fetch_set("solomon", tmp_path / "file", "http://127.0.0.1:1")


def test_every_set_has_a_home_of_its_own_and_says_that_it_is_unverified() -> None:
    for name, entry in f.SETS.items():
        assert name == entry.name
        assert entry.base_url.startswith(("http://", "https://"))
        assert entry.archives and all(s.startswith(".") for s in entry.suffixes)
        assert entry.status == "unverified home"
