"""Vector operations that only compiled lanes have: fused multiply-add, gather and scatter, bits of a mask."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from rockcli.kernels.lane_compiled import DOUBLES, INTEGERS, WIDTH, _doubles, mask, vector

operation: Any = intrinsic  # whose calls are not those the checker sees: numba adds the first argument


@operation
def fma(typingctx: Any, a: Any, b: Any, c: Any) -> Any:
    """a b + c rounded once, the same bits on every machine; each a vector or a number."""
    kinds = [x if x == vector else types.float64 for x in (a, b, c)]

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        numbers = [_doubles(builder, x, kind) for x, kind in zip(args, sig.args, strict=True)]
        kind = ir.FunctionType(DOUBLES, [DOUBLES] * 3)
        fused = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fma.v{WIDTH}f64")
        return builder.call(fused, numbers)

    return vector(*kinds), codegen


@operation
def gather(typingctx: Any, array: Any, index: Any) -> Any:
    """array[index], the index a vector of whole numbers, within the array."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        places = builder.fptosi(args[1], INTEGERS)
        found = ir.Constant(DOUBLES, ir.Undefined)
        for lane in range(WIDTH):
            number = ir.Constant(ir.IntType(32), lane)
            place = builder.gep(data, [builder.extract_element(places, number)])
            found = builder.insert_element(found, builder.load(place), number)
        return found

    return vector(array, vector), codegen


@operation
def scatter(typingctx: Any, array: Any, index: Any, value: Any) -> Any:
    """array[index] = value, lane by lane; where two lanes share a place the later one stays."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        places = builder.fptosi(args[1], INTEGERS)
        for lane in range(WIDTH):
            number = ir.Constant(ir.IntType(32), lane)
            place = builder.gep(data, [builder.extract_element(places, number)])
            builder.store(builder.extract_element(args[2], number), place)
        return context.get_dummy_value()

    return types.void(array, vector, vector), codegen


@operation
def bits(typingctx: Any, where: Any) -> Any:
    """The mask as a whole number, lane 0 the lowest bit."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.zext(builder.bitcast(args[0], ir.IntType(WIDTH)), ir.IntType(64))

    return types.int64(mask), codegen


@operation
def lowest_bit(typingctx: Any, number: Any) -> Any:
    """Place of the lowest bit set of a number that is not zero."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), codegen
