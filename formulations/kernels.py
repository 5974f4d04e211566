"""Numba kernels of declared types, made on first use or by ``waybound warm``, cached on disk where that is possible.

Imports numba: import it inside functions only, or in modules whose names end with ``_kernels``.
"""

import contextlib
import gc
import importlib
import pkgutil
from collections.abc import Callable, Iterator
from typing import Any

import numba
import numpy as np
from numba.core import errors, sigutils, types
from numba.core.compiler import CompilerBase, DefaultPassBuilder, Flags
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher
from numba.core.types.containers import BaseTuple
from numba.core.types.misc import unliteral

from .stop import off_the_clock

_outer: list[Any] = []
"""The kernels that are being compiled, each for the one before."""

_UNNEEDED = {
    "AnnotateTypes",
    "WithLifting",
    "InlineClosureLikes",
    "RewriteDynamicRaises",
    "MakeFunctionToJitFunction",
    "InlineInlinables",
    "LiteralUnroll",
    "LiteralPropagationSubPipelinePass",
    "InlineOverloads",
    "NopythonRewrites",
    "DumpParforDiagnostics",
}
"""Passes of numba for closures, comprehensions, ``with``, errors with texts made at run time, ``literal_unroll``, ``inline="always"``,
arithmetic on whole arrays and parallel loops. Kernels have none of them, and each pass reads the whole function."""


class _Flags(Flags):  # type: ignore[misc]
    """Options of a kernel. Numba looks them up for each operator that it types, and its own compare all forty by their properties."""

    __slots__ = ()
    _hash = hash(Flags())  # of their names alone

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Flags):
            return NotImplemented
        return bool(self._values == other._values or self.values() == other.values())

    def __hash__(self) -> int:
        return self._hash

    def values(self) -> dict[str, Any]:
        """All options, those that are not set by their defaults."""
        return {**_DEFAULTS, **self._values}


_DEFAULTS = {name: option.default for name, option in Flags.options.items()}


class _Passes(CompilerBase):  # type: ignore[misc]
    """Numba's own compiler without the passes that no kernel needs."""

    def define_pipelines(self) -> list[Any]:
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.passes = [one for one in passes.passes if one[0].__name__ not in _UNNEEDED]
        passes.finalize()
        return [passes]


class Kernel(CPUDispatcher):  # type: ignore[misc]
    """A compiled loop. One with declared types takes these and what converts to them; one without is compiled for whatever it is given."""

    declared: tuple[str, ...] = ()
    _parsed: list[Any] | None = None

    @property
    def title(self) -> str:
        """Its module and its name."""
        return f"{self.py_func.__module__.partition('.')[2]}.{self.py_func.__name__}"

    def compile(self, sig: Any) -> Any:
        """Compile for these types, or load what was compiled; no deadline comes nearer meanwhile."""
        known = self.overloads.get(tuple(sigutils.normalize_signature(sig)[0]))
        if known is not None:
            return known.entry_point
        with off_the_clock("" if self._keeps(sig) or _outer else self.title):
            _outer.append(self)
            try:
                with _uncollected(), _uncoloured(), _remembering():
                    return super().compile(sig)
            finally:
                _outer.pop()

    def make(self) -> None:
        """Compile or load it for all declared types, if that was not done yet."""
        with global_compiler_lock:
            if self._can_compile:
                for signature in self._signatures():
                    self.compile(signature)
                if self.declared:
                    self.disable_compile()

    @property
    def made(self) -> bool:
        """Whether the kernel is compiled or loaded in this process, for all types that it declares."""
        return not self._can_compile

    def kept(self) -> bool:
        """Whether it can be used without compiling: it is loaded, or in the cache."""
        return self.made or self.cached()

    def cached(self) -> bool:
        """Whether all its types are in the cache on disk."""
        return all(self._keeps(signature) for signature in self._signatures())

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """For kernels that call it. It is not compiled anew for each constant or width of whole numbers."""
        if len(self.declared) == 1:
            self.make()
        return super().get_call_template(tuple(map(_widened, args)), {name: _widened(kind) for name, kind in kws.items()})

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        if not self.declared:
            return super()._compile_for_args(*args, **kws)
        if len(self.declared) == 1:
            self.make()
            return self  # called again, now that it converts what it is given
        kinds = [self.typeof_pyval(value) for value in args]
        for signature in self._signatures():
            wanted = sigutils.normalize_signature(signature)[0]
            if all(self.typingctx.can_convert(one, other) is not None for one, other in zip(kinds, wanted, strict=True)):
                return self.compile(signature)
        raise TypeError(f"{self.title} is declared for {' or '.join(self.declared)}, not for ({', '.join(map(str, kinds))})")

    def _signatures(self) -> list[Any]:
        if self._parsed is None:
            words = {**vars(types), **self.py_func.__globals__, **_WORDS}
            self._parsed = [eval(text, words) for text in self.declared]  # our own source, not data
        return self._parsed

    def _keeps(self, sig: Any) -> bool:
        try:
            return self._cache._index_key(sig, self.targetctx.codegen()) in self._cache._cache_file._load_index()
        except Exception:  # no cache, or one that cannot be read
            return False


def kernel(*declared: str, **options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """``numba.njit`` with its cache on disk; without one where no folder for it can be written (containers, system installs).

    Python's lock is released: a kernel that takes long looks at a flag that others set meanwhile (``stop_kernel.asked``). Closures,
    comprehensions and errors with texts made at run time are refused: the passes of numba that would handle them are left out.

    Parameters
    ----------
    declared : str, optional
        Types that it takes, in the words of numba: ``f8(f8[::1], i8)``, or ``(f8[::1], i8)`` where what it returns is found.
        ``read(f8[::1])`` takes read-only arrays and others, ``named(Graph, ...)`` a named tuple. It is compiled for these alone, when
        it is first called. What Python calls declares its types, so that it can be compiled without being run.
    **options
        Further options of ``numba.njit``.
    """
    options = {"nogil": True, "no_cfunc_wrapper": True, "pipeline_class": _Passes, **options}

    def made(function: Callable[..., Any]) -> Kernel:
        try:
            found = numba.njit(cache=True, **options)(function)
            found._cache.save_overload = _forgiving(found._cache.save_overload)
            kept = found._cache._cache_file
            kept._source_stamp = (kept._source_stamp, *_stamps(function))
        except (RuntimeError, OSError):  # RuntimeError is numba's word for "no locator available": nowhere to keep the cache
            found = numba.njit(**options)(function)
        found.__class__ = Kernel
        found._compiler._customize_flags = _Flags
        found.declared = declared
        return found  # type: ignore[no-any-return]

    return made


def _stamps(function: Callable[..., Any]) -> list[Any]:
    """Stamps of the files from which its module imports kernels, and the numbers that it knows by name, which may be those of a further
    file: where one of them changes, what was compiled is of no use."""
    imported = {id(one): one for one in function.__globals__.values() if isinstance(one, Kernel)}.values()
    files = (getattr(one._cache, "_cache_file", None) for one in imported if one.py_func.__module__ != function.__module__)
    numbers = {name: repr(value) for name, value in function.__globals__.items() if isinstance(value, (int, float, np.number))}
    return [tuple(sorted(numbers.items())), *sorted({file._source_stamp for file in files if file is not None}, key=repr)]


inner = kernel(no_cpython_wrapper=True)
"""For what only kernels call: nothing is made to call it from Python."""


def kernels(module: str) -> list[Kernel]:
    """The kernels of a module that declare their types."""
    held = vars(importlib.import_module(module)).values()
    return [one for one in held if isinstance(one, Kernel) and one.declared and one.py_func.__module__ == module]


def kernel_modules(above: str = __name__.partition(".")[0]) -> Iterator[str]:
    """Names of all modules of kernels below a package."""
    package = importlib.import_module(above)
    for module in pkgutil.iter_modules(package.__path__, f"{above}."):
        if module.ispkg:
            yield from kernel_modules(module.name)
        elif module.name.endswith("_kernels"):
            yield module.name


@contextlib.contextmanager
def _uncollected() -> Iterator[None]:
    """Switch garbage collection off while a kernel is compiled: it would take a tenth of the time, and find next to nothing to collect."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


class _Uncoloured:
    """Marks nothing in a text."""

    @staticmethod
    def code(text: str) -> str:
        return text

    errmsg = filename = indicate = highlight = reset = code


@contextlib.contextmanager
def _uncoloured() -> Iterator[None]:
    """Switch off colours in numba's errors: it raises and drops tens of thousands while it compiles, and asks the terminal for each."""
    before = errors.termcolor()
    errors._termcolor_inst = _Uncoloured()  # type: ignore[attr-defined]
    try:
        yield
    finally:
        errors._termcolor_inst = before  # type: ignore[attr-defined]


@contextlib.contextmanager
def _remembering() -> Iterator[None]:
    """Cache the type that an operator returns for given types: numba searches all definitions of the operator at each use."""
    before = types.Function.get_call_type
    if before.__module__ == __name__:
        yield
        return

    def resolved(operator: Any, context: Any, args: Any, kws: Any) -> Any:
        if kws:
            return before(operator, context, args, kws)
        if (operator, args) not in _known:
            _known[operator, args] = before(operator, context, args, kws)
        return _known[operator, args]

    types.Function.get_call_type = resolved  # type: ignore[method-assign,assignment]
    try:
        yield
    finally:
        types.Function.get_call_type = before  # type: ignore[method-assign]


_known: dict[tuple[Any, Any], Any] = {}


def _read(kind: Any) -> Any:
    return kind.copy(readonly=True)


def _named(cls: Any, *kinds: Any) -> Any:
    return BaseTuple.from_types(kinds, cls)


_WORDS = {"read": _read, "named": _named}


def _widened(kind: Any) -> Any:
    kind = unliteral(kind)
    return types.intp if kind in types.signed_domain else kind


def _forgiving(save: Callable[..., None]) -> Callable[..., None]:
    """``save``, which may fail: on a full disk a kernel is compiled anew each time."""

    def attempt(*given: Any) -> None:
        with contextlib.suppress(OSError):
            save(*given)

    return attempt
