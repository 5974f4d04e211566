"""Errors by their codes, for ``pytest.raises(..., check=coded("duplicate"))``."""

from collections.abc import Callable
from typing import get_args

from waybound.instances.errors import Code, WayboundError


def coded(code: Code) -> Callable[[BaseException], bool]:
    """Whether an error is one of this code."""
    assert code in get_args(Code)
    return lambda error: isinstance(error, WayboundError) and error.code == code
