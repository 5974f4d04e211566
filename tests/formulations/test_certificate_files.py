import gzip
import hashlib
import json
import os
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coded import coded
from programs import INF, program

import waybound as wb
from waybound import CheckFailedError, Evidence, InputError
from waybound.formulations import certificate_files
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import Certificate, certify, check_certificate
from waybound.formulations.certificate_files import LARGE, read_certificate, write_certificate


def covering(rows: int) -> tuple[ArrayProblem, Certificate]:
    """min x over x >= 1 in many rows."""
    problem = ArrayProblem(program([1.0], np.ones((rows, 1)), 1.0, INF))
    evidence = Evidence("lp-dual", "duals", 1.0, {"duals": [1.0 / rows] * rows})
    return problem, certify(problem, problem.evaluate([1.0]), [evidence])


@pytest.fixture
def written(tmp_path: Path) -> tuple[ArrayProblem, Path, Path]:
    problem, certificate = covering(8000)
    write_certificate(certificate, tmp_path / "c.json")
    return problem, tmp_path / "c.json", tmp_path / "c.evidence.json.gz"


def test_little_evidence_stands_in_the_certificate_itself(tmp_path: Path) -> None:
    problem, certificate = covering(3)
    write_certificate(certificate, tmp_path / "c.json")
    assert [p.name for p in tmp_path.iterdir()] == ["c.json"]
    assert check_certificate(problem, read_certificate(tmp_path / "c.json"), None).bound == certificate.bound


def test_much_evidence_stands_beside_it_and_is_verified(written: Any) -> None:
    problem, path, beside = written
    data = json.loads(path.read_text())
    assert data["evidence"] == {"file": beside.name, "sha256": hashlib.sha256(beside.read_bytes()).hexdigest()}
    assert path.stat().st_size < LARGE / 10
    assert check_certificate(problem, read_certificate(path), problem.evaluate([1.0])).bound == pytest.approx(1.0)
    assert wb.check(problem, [1.0], path).bound == pytest.approx(1.0)


def test_the_same_certificate_is_written_to_the_byte(written: Any, tmp_path: Path) -> None:
    _, path, beside = written
    before = path.read_bytes(), beside.read_bytes()
    write_certificate(covering(8000)[1], path)
    assert (path.read_bytes(), beside.read_bytes()) == before
    assert len(list(tmp_path.iterdir())) == 2


def test_a_link_leads_to_both_files(written: Any, tmp_path: Path) -> None:
    problem, path, _ = written
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "link.json").symlink_to(path)
    assert check_certificate(problem, read_certificate(elsewhere / "link.json"), None).bound == pytest.approx(1.0)


def test_read_apart_from_its_file_it_says_so(written: Any) -> None:
    problem, path, _ = written
    with pytest.raises(InputError, check=coded("missing")):
        check_certificate(problem, json.loads(path.read_text()), None)


def test_missing_evidence_is_one_clear_error(written: Any) -> None:
    _, path, beside = written
    beside.unlink()
    with pytest.raises(InputError, match=r"c\.evidence\.json\.gz: no such file"):
        read_certificate(path)


@pytest.mark.parametrize("where", [0, 12, -1])
def test_changed_evidence_is_one_clear_error(written: Any, where: int) -> None:
    _, path, beside = written
    data = bytearray(beside.read_bytes())
    data[where] ^= 1
    beside.write_bytes(data)
    with pytest.raises(CheckFailedError, match="its SHA-256 differs"):
        read_certificate(path)


def named(path: Path, beside: Path, packed: bytes) -> None:
    """Evidence of a forger, who knows how to name it."""
    beside.write_bytes(packed)
    data = json.loads(path.read_text())
    path.write_text(json.dumps({**data, "evidence": {"file": beside.name, "sha256": hashlib.sha256(packed).hexdigest()}}))


@pytest.mark.parametrize(
    ("packed", "says"),
    [
        (b"no gzip", "is no gzip file"),
        (b"", "an end before the end"),
        (gzip.compress(b"[]")[:-4], "an end before the end"),
        (gzip.compress(b"[]") + gzip.compress(b"[]"), "something after its end"),
        (gzip.compress(b"[]") + b"more", "something after its end"),
        (gzip.compress(b"[NaN]"), "JSON has no such number"),
        (gzip.compress(b"\\xff"), "is no JSON"),
        (gzip.compress(b"\xff"), "is not UTF-8"),
        (gzip.compress(b""), "is empty"),
        (gzip.compress(b"[" * 200_000), "nested too deeply"),
    ],
    ids=lambda given: given if isinstance(given, str) else "",  # packed bytes hold the instant: no name that two workers share
)
def test_what_is_no_packed_evidence_is_refused(written: Any, packed: bytes, says: str) -> None:
    _, path, beside = written
    named(path, beside, packed)
    with pytest.raises(InputError, match=says) as told:
        read_certificate(path)
    assert beside.name in str(told.value)


def test_a_bomb_is_refused_before_it_is_unpacked(written: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    _, path, beside = written
    monkeypatch.setattr(certificate_files, "MOST_BYTES", 1_000_000)
    named(path, beside, gzip.compress(b"[" + b" " * 50_000_000 + b"]", 1))
    with pytest.raises(InputError, check=coded("too-large")):
        read_certificate(path)


def test_forged_evidence_proves_what_it_proves(written: Any) -> None:
    problem, path, beside = written
    entries = json.loads(gzip.decompress(beside.read_bytes()))
    entries[0]["data"]["duals"] = [0.5 / 8000] * 8000
    named(path, beside, gzip.compress(json.dumps(entries).encode()))
    with pytest.raises(CheckFailedError, match="states the bound"):
        check_certificate(problem, read_certificate(path), None)


ELSEWHERE = [(name, "malformed") for name in ("../c.evidence.json.gz", "/etc/passwd", "c.json", "", None, 7, ["c.evidence.json.gz"])]


@pytest.mark.parametrize(("name", "code"), [*ELSEWHERE, ("\0.evidence.json.gz", "file")])
def test_evidence_elsewhere_is_refused(written: Any, name: Any, code: Any) -> None:
    _, path, _ = written
    data = json.loads(path.read_text())
    data["evidence"]["file"] = name
    path.write_text(json.dumps(data))
    with pytest.raises(InputError, check=coded(code)):
        read_certificate(path)


@pytest.mark.parametrize("broken", ["atomic_file", "atomic_write"])
def test_where_one_file_fails_both_stay_as_they_were(written: Any, monkeypatch: pytest.MonkeyPatch, broken: str) -> None:
    problem, path, beside = written
    before = path.read_bytes(), beside.read_bytes()

    def full(*given: Any) -> None:
        raise InputError("cannot be written: no space left on device", file=path)

    monkeypatch.setattr(certificate_files, broken, full)
    with pytest.raises(InputError, match="no space"):
        write_certificate(covering(9000)[1], path)
    assert (path.read_bytes(), beside.read_bytes()) == before
    assert len(list(path.parent.iterdir())) == 2
    assert check_certificate(problem, read_certificate(path), None).bound == pytest.approx(1.0)


def test_nothing_stands_beside_a_pipe(tmp_path: Path) -> None:
    pipe, read = tmp_path / "pipe", list[str]()
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_certificate(covering(8000)[1], pipe)
    reader.join()
    assert isinstance(json.loads(read[0])["evidence"], list)


def test_a_certificate_saves_itself_and_its_bound_is_derived_again(tmp_path: Path) -> None:
    problem, certificate = covering(3)
    certificate.save(tmp_path / "proof.json")
    assert wb.check(problem, [1.0], tmp_path / "proof.json").bound == certificate.bound is not None
    with pytest.raises(wb.UsageError, match=r"a certificate is written as \.json"):
        certificate.save(tmp_path / "proof.txt")
    assert not (tmp_path / "proof.txt").exists()
