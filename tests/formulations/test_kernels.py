import importlib
import importlib.util
import operator
import os
import pkgutil
import sys
from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba.core.compiler import Flags
from numba.core.registry import cpu_target

from waybound.formulations import kernels
from waybound.formulations.kernels import Kernel, _Flags, inner, kernel, kernel_modules
from waybound.formulations.stop import hearing


def test_a_kernel_works_where_no_cache_can_be_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = numba.njit

    def without_folder(*signature: str, **options: bool):
        if options.get("cache"):
            raise RuntimeError("cannot cache function: no locator available")
        return plain(*signature)

    monkeypatch.setattr(numba, "njit", without_folder)

    @kernel()
    def twice(x):
        return 2 * x

    assert twice(21) == 42


def test_declared_types_are_compiled_once_and_take_what_converts_to_them() -> None:
    @kernel("(read(f8[::1]), f8)")
    def scaled(values, factor):  # type: ignore[no-untyped-def]
        return values[0] * factor

    frozen = np.array([3.0])
    frozen.setflags(write=False)
    assert [scaled(frozen, 2.0), scaled(np.array([3.0]), 2), scaled(frozen, np.int32(2))] == [6.0] * 3
    assert len(scaled.signatures) == 1
    with pytest.raises(TypeError, match="No matching definition"):
        scaled(np.array([3]), 2.0)


def test_of_several_declared_types_only_those_that_are_given_are_compiled() -> None:
    @kernel("(f8[::1],)", "(i8[::1],)")
    def first(values):  # type: ignore[no-untyped-def]
        return values[0]

    assert first(np.array([7])) == 7 and len(first.signatures) == 1
    assert first(np.array([0.5])) == 0.5 and len(first.signatures) == 2
    with pytest.raises(TypeError, match="is declared for"):
        first(np.array([True]))


def test_options_compare_as_numba_compares_them() -> None:
    plain = Flags()
    plain.nrt = True
    ours = _Flags(plain)
    assert ours == plain and plain == ours and hash(ours) == hash(plain) and ours.values() == plain.values()
    assert type(ours.copy()) is _Flags
    explicit = ours.copy()
    explicit.boundscheck = plain.boundscheck  # set to its default
    assert explicit == ours and explicit == plain
    explicit.nrt = False
    assert explicit != ours and explicit != plain and plain != explicit
    assert ours != "flags"


def test_kernels_are_compiled_as_numba_compiles_them() -> None:
    """Passes that are left out change nothing but the time."""

    def largest(values, factor):  # type: ignore[no-untyped-def]
        best = -1.0
        for k in range(len(values)):
            if k % 2 == 0 and values[k] * factor > best:
                best = values[k] * factor
        return best, values + factor

    given = np.arange(7.0), 3.0
    ours, plain = kernel("(f8[::1], f8)")(largest), numba.njit(largest)
    assert ours(*given)[0] == plain(*given)[0] and (ours(*given)[1] == plain(*given)[1]).all()


class Pair(NamedTuple):
    left: np.ndarray
    right: np.ndarray


def test_numba_is_asked_once_for_each_operator_and_types(monkeypatch: pytest.MonkeyPatch) -> None:
    """And as it always was before and after."""
    asked: list[tuple[str, str]] = []
    before = numba.types.Function.get_call_type

    def counted(operator, context, args, kws):  # type: ignore[no-untyped-def]
        asked.append((str(operator), str(args)))
        return before(operator, context, args, kws)

    monkeypatch.setattr(numba.types.Function, "get_call_type", counted)
    monkeypatch.setattr(kernels, "_known", {})

    context = cpu_target.typing_context
    add = context.resolve_value_type(operator.add)
    with kernels._remembering():
        found = [add.get_call_type(context, (numba.float32, numba.float32), {}) for _ in range(3)]
        with kernels._remembering():
            add.get_call_type(context, (numba.float32, numba.float32), {})
    assert found[0] == found[1] == found[2] == numba.float32(numba.float32, numba.float32)
    assert asked == [("Function(<built-in function add>)", "(float32, float32)")]
    assert numba.types.Function.get_call_type is counted


def test_named_tuples_are_declared_by_name() -> None:
    @kernel("(named(Pair, f8[::1], f8[::1]),)")
    def both(pair):  # type: ignore[no-untyped-def]
        return pair.left[0] + pair.right[0]

    assert both(Pair(np.ones(1), np.ones(1))) == 2.0


def test_what_is_compiled_is_told_and_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))

    @inner
    def less(x):  # type: ignore[no-untyped-def]
        return x - 1

    def made() -> Kernel:
        @kernel("i8(i8)")
        def lesser(x):  # type: ignore[no-untyped-def]
            return less(x) - 1

        return lesser

    told: list[str] = []
    with hearing(lambda what, seconds: told.append(what)):
        one = made()
        assert not one.kept() and not one.made
        assert one(5) == 3 and one.kept() and one.made
    assert [what.rpartition(".")[2] for what in told if what] == ["lesser", "lesser"], "as it begins and as it ends, parts untold"
    other = made()
    assert other.kept()
    with hearing(lambda what, seconds: told.append(what)):
        assert other(5) == 3
    assert len([what for what in told if what]) == 2, "loaded without a word"


@pytest.mark.parametrize("module", list(kernel_modules()))
def test_whatever_python_calls_declares_its_types(module: str) -> None:
    """So that ``waybound warm`` compiles it; what only kernels call is ``inner``."""
    held = [one for one in vars(importlib.import_module(module)).values() if isinstance(one, Kernel) and one.py_func.__module__ == module]
    undeclared = [one.title for one in held if not one.declared and not one.targetoptions.get("no_cpython_wrapper")]
    assert not undeclared
    for one in held:
        one._signatures()


def test_kernels_lie_in_modules_of_their_own() -> None:
    import waybound

    for module in pkgutil.walk_packages(waybound.__path__, "waybound."):
        spec = importlib.util.find_spec(module.name)
        assert spec is not None and spec.origin is not None
        if not module.name.endswith(("_kernels", ".kernels")) and "notebooks" not in module.name:
            assert "@kernel(" not in Path(spec.origin).read_text(encoding="utf-8"), module.name


def test_what_is_compiled_of_imported_kernels_is_compiled_anew_when_their_file_changes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Numba itself looks at the file of the outer one alone."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(str(tmp_path))
    importing = "from waybound.formulations.kernels import kernel\n"
    (tmp_path / "outer_part.py").write_text(
        f"from inner_part import less\n{importing}@kernel('i8(i8)')\ndef lesser(x):\n    return less(x)\n"
    )

    def answer(text: str, written: int) -> tuple[bool, int]:
        part = tmp_path / "inner_part.py"
        part.write_text(f"{importing}@kernel(no_cpython_wrapper=True)\ndef less(x):\n    return {text}\n")
        os.utime(part, (written, written))
        importlib.invalidate_caches()
        for name in ("inner_part", "outer_part"):
            monkeypatch.delitem(sys.modules, name, raising=False)
        lesser = importlib.import_module("outer_part").lesser
        return lesser.kept(), lesser(5)

    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert answer("x - 1", 1) == (False, 4)
    assert answer("x - 1", 1) == (True, 4)
    assert answer("x - 2", 2) == (False, 3)


def test_what_was_compiled_with_another_number_of_another_module_is_of_no_use() -> None:
    made = []
    for number in (1, 2, 1.0, np.int64(1)):
        known = {"__name__": __name__, "COLUMN": number}
        exec("def chosen(rows): return rows[COLUMN]", known)
        made.append(kernels._stamps(known["chosen"])[0])
    assert len(set(made)) == 4
