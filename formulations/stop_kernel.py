"""How compiled loops look at the flag of a ``Stop``. Imports numba: import it inside functions only."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic


@intrinsic  # type: ignore[untyped-decorator]
def asked(typing: Any, flag: Any) -> Any:
    """Whether the flag is set. An atomic load: a plain one would be taken out of the loop that asks."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        word = builder.load_atomic(array.data, "monotonic", 8)
        return builder.icmp_signed("!=", word, ir.Constant(word.type, 0))

    return types.boolean(flag), code
