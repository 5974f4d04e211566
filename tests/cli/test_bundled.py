"""``waybound instances``: what is bundled, and what can be fetched."""

from __future__ import annotations

import http.server
import threading
import zipfile

import pytest

import waybound as wb


def test_bundled_instances_are_listed_shown_and_found(run, strict_json):
    listed = strict_json(run("instances", "list", "--json").stdout)
    names = [entry["name"] for entry in listed["bundled"]]
    assert "demo-c25" in names
    assert "demo-c25" in run("instances", "list").stdout
    assert wb.read(run("instances", "path", "demo-c25").stdout.strip()).digest() == wb.read("demo-c25").digest()
    assert run("instances", "show", "demo-x40").stdout.startswith("NAME")
    assert all(entry["status"] == "unverified home" for entry in listed["sets"])


@pytest.mark.parametrize("command", ["path", "show"])
def test_an_unknown_bundled_name_lists_the_known_ones(refused, command):
    assert "demo-c25" in refused("instances", command, "demo-z99")


@pytest.fixture
def home(tmp_path):
    """A set's home on the loopback address."""
    folder = tmp_path / "home"
    folder.mkdir()

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def __init__(self, *given, **named):
            super().__init__(*given, directory=str(folder), **named)

        def log_message(self, *given):
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Quiet) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield folder, f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


def test_a_set_is_fetched_from_its_home(run, home, tmp_path):
    from waybound.instances.bundled import bundled_path
    from waybound.instances.fetch import SETS

    folder, address = home
    with zipfile.ZipFile(folder / SETS["solomon"].archives[0], "w") as archive:
        archive.write(bundled_path("demo-c25"), "In/c25.txt")
    result = run("instances", "fetch", "solomon", "--to", tmp_path / "got", "--base-url", address)
    assert result.exit_code == 0, result.stderr
    (found,) = (tmp_path / "got").rglob("*.txt")
    assert found.read_bytes() == bundled_path("demo-c25").read_bytes()


def test_a_home_that_does_not_hold_the_set_leaves_nothing_behind(refused, home, tmp_path):
    assert "404" in refused("instances", "fetch", "solomon", "--to", tmp_path / "got", "--base-url", home[1])
    assert not (tmp_path / "got").exists()


def test_an_unknown_set_lists_the_known_ones(refused):
    assert "solomon" in refused("instances", "fetch", "nothing")
