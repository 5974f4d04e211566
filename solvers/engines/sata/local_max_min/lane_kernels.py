"""Eight doubles as one value in compiled code: numba leaves loops over eight entries scalar, which costs a factor of two here.

Imports numba: import it inside functions only.
"""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.datamodel import models, register_default
from numba.extending import intrinsic

from .....formulations.kernels import kernel

WIDTH = 8
"""Lanes of a value: one cache line."""

inlined = kernel(forceinline=True, no_cpython_wrapper=True)
"""For the small functions that kernels are made of: calls would cost more than what they do."""

_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)


class _Lanes(types.Type):
    def __init__(self) -> None:
        super().__init__(name="lanes")


_LANES = _Lanes()


@register_default(_Lanes)
class _LanesModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)


def _row(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Pointer to row ``arguments[1]`` of the C-contiguous array ``arguments[0]`` of shape (rows, 8)."""
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    row = context.cast(builder, arguments[1], signature.args[1], types.intp)
    start = builder.gep(array.data, [builder.mul(row, ir.Constant(row.type, WIDTH))])
    return builder.bitcast(start, _VECTOR.as_pointer())


@intrinsic  # type: ignore[untyped-decorator]
def load(typing: Any, array: Any, row: Any) -> Any:
    """Row ``row`` of an array of shape (rows, 8); no bounds are checked."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_row(context, builder, signature, arguments), align=8)

    return _LANES(array, row), code


@intrinsic  # type: ignore[untyped-decorator]
def store(typing: Any, array: Any, row: Any, value: Any) -> Any:
    """Write row ``row`` of an array of shape (rows, 8); no bounds are checked."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[2], _row(context, builder, signature, arguments), align=8)
        return context.get_dummy_value()

    return types.void(array, row, value), code


@intrinsic  # type: ignore[untyped-decorator]
def splat(typing: Any, number: Any) -> Any:
    """The same double in all lanes."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        whole = ir.IntType(32)
        nothing = ir.Constant(_VECTOR, ir.Undefined)
        first = builder.insert_element(nothing, arguments[0], ir.Constant(whole, 0))
        return builder.shuffle_vector(first, nothing, ir.Constant(ir.VectorType(whole, WIDTH), [0] * WIDTH))

    return _LANES(types.float64), code


def _binary(operation: Callable[[Any, Any, Any], Any]) -> Any:
    @intrinsic  # type: ignore[untyped-decorator]
    def apply(typing: Any, a: Any, b: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return operation(builder, arguments[0], arguments[1])

        return _LANES(a, b), code

    return apply


add = _binary(lambda builder, a, b: builder.fadd(a, b))
subtract = _binary(lambda builder, a, b: builder.fsub(a, b))
multiply = _binary(lambda builder, a, b: builder.fmul(a, b))
larger = _binary(lambda builder, a, b: builder.select(builder.fcmp_ordered(">", a, b), a, b))
