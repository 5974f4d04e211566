"""Errors by their codes, for ``pytest.raises(..., check=coded("duplicate"))``."""

from collections.abc import Callable
from typing import Any, get_args

import pytest

from waybound.instances.errors import Code, WayboundError


def coded(code: Code) -> Callable[[BaseException], bool]:
    """Whether an error is one of this code."""
    assert code in get_args(Code)
    return lambda error: isinstance(error, WayboundError) and error.code == code


def check_coded(error: type[Exception], code: Code, call: Callable[..., Any], *arguments: Any, **settings: Any) -> None:
    """A call ends with an error of this type and code."""
    with pytest.raises(error, check=coded(code)):
        call(*arguments, **settings)
