from __future__ import annotations

import numba
import pytest

from waybound.formulations.kernels import kernel


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
