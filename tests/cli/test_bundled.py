"""``waybound instances``: what is bundled."""

from __future__ import annotations

import pytest

import waybound as wb


def test_bundled_instances_are_listed_shown_and_found(run, strict_json):
    listed = strict_json(run("instances", "list", "--json").stdout)
    names = [entry["name"] for entry in listed["bundled"]]
    assert "demo-c25" in names
    assert "demo-c25" in run("instances", "list").stdout
    assert wb.read(run("instances", "path", "demo-c25").stdout.strip()).digest() == wb.read("demo-c25").digest()
    assert run("instances", "show", "demo-x40").stdout.startswith("NAME")


@pytest.mark.parametrize("command", ["path", "show"])
def test_an_unknown_bundled_name_lists_the_known_ones(refused, command):
    assert "demo-c25" in refused("instances", command, "demo-z99")
