"""What only compiled lanes have: gather and scatter in one instruction, bits of a mask, a frame of their own."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.compiled import BITS, DOUBLES, INTEGERS, mask, vector

operation: Any = intrinsic  # whose calls are not those the checker sees: numba adds the first argument


ADDRESSES = ir.VectorType(ir.PointerType(), WIDTH)
INT = ir.IntType(32)
EVERY, ALIGNMENT = ir.Constant(BITS, [1] * WIDTH), ir.Constant(INT, 8)


def _addresses(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    """Of the elements of an array that a vector of whole numbers names."""
    first = builder.ptrtoint(context.make_array(array_type)(context, builder, array).data, ir.IntType(64))
    one = builder.insert_element(ir.Constant(INTEGERS, ir.Undefined), first, ir.Constant(INT, 0))
    begin = builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(INT, WIDTH), [0] * WIDTH))
    bytes_on = builder.shl(builder.fptosi(index, INTEGERS), ir.Constant(INTEGERS, [3] * WIDTH))
    return builder.inttoptr(builder.add(begin, bytes_on), ADDRESSES)


def _memory(builder: Any, name: str, result: Any, arguments: list[Any]) -> Any:
    """Call the masked gather or scatter of LLVM: one instruction where the machine has it."""
    kind = ir.FunctionType(result, [x.type for x in arguments])
    name = f"llvm.masked.{name}.v{WIDTH}f64.v{WIDTH}p0"
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), arguments)


@operation
def gather(typingctx: Any, array: Any, index: Any) -> Any:
    """array[index], the index a vector of whole numbers, within the array."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        places = _addresses(context, builder, sig.args[0], *args)
        return _memory(builder, "gather", DOUBLES, [places, ALIGNMENT, EVERY, ir.Constant(DOUBLES, ir.Undefined)])

    return vector(array, vector), codegen


@operation
def scatter(typingctx: Any, array: Any, index: Any, value: Any) -> Any:
    """array[index] = value, lane by lane; where two lanes share a place the later one stays."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        places = _addresses(context, builder, sig.args[0], args[0], args[1])
        _memory(builder, "scatter", ir.VoidType(), [args[2], places, ALIGNMENT, EVERY])
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


@operation
def page_the_stack(typingctx: Any) -> Any:
    """Let the frame of the function that calls it begin with a page of memory.

    What does not fit the registers is kept there.  A load waits for a store before it whose address has the same low
    12 bits, and where the stack begins is chance: without this, runs of the record lanes differed by a fifth with it.
    """

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = cgutils.alloca_once(builder, DOUBLES)
        place.align = 4096
        used = ir.FunctionType(ir.VoidType(), [place.type])
        builder.asm(used, "", "r", [place], side_effect=True)  # or it would be left out
        return context.get_dummy_value()

    return types.void(), codegen
