"""Reads the flag of a ``Stop`` in compiled loops. Imports numba: import it inside functions only."""

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic


@intrinsic  # type: ignore[untyped-decorator]
def asked(typing: Any, flag: Any) -> Any:
    """Whether the flag is set. An atomic load: the compiler would move a plain one out of the loop."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        word = builder.load_atomic(array.data, "monotonic", 8)
        return builder.icmp_signed("!=", word, ir.Constant(word.type, 0))

    return types.boolean(flag), code
