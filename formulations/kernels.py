"""Numba kernels, cached on disk where that is possible."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any


def kernel(*signature: str, **options: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """``numba.njit`` with its cache on disk; without one where no folder for it can be written (containers, system installs).

    Python's lock is released: a kernel that takes long looks at a flag that others set meanwhile (``stop_kernel.asked``).

    Parameters
    ----------
    signature : str, optional
        Compiles for these types at once.
    **options
        Further options of ``numba.njit``.
    """
    import numba

    options.setdefault("nogil", True)

    def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
        try:
            made = numba.njit(*signature, cache=True, **options)(function)
        except (RuntimeError, OSError):  # RuntimeError is numba's word for "no locator available": nowhere to keep the cache
            return numba.njit(*signature, **options)(function)  # type: ignore[no-any-return]
        made._cache.save_overload = _forgiving(made._cache.save_overload)
        made.get_call_template = _once(made.get_call_template)
        return made  # type: ignore[no-any-return]

    return compiled


def _once(template: Callable[..., Any]) -> Callable[..., Any]:
    """``template``, which kernels ask for the kernels that they call: not compiled anew for each constant or width of whole numbers."""
    from numba.core import types
    from numba.core.types.misc import unliteral

    def widened(kind: Any) -> Any:
        kind = unliteral(kind)
        return types.intp if kind in types.signed_domain else kind

    return lambda args, kws: template(tuple(widened(kind) for kind in args), {name: widened(kind) for name, kind in kws.items()})


def _forgiving(save: Callable[..., None]) -> Callable[..., None]:
    """``save``, which may fail: on a full disk a kernel is compiled anew each time."""

    def attempt(*given: Any) -> None:
        with contextlib.suppress(OSError):
            save(*given)

    return attempt
