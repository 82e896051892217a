"""`plain` for compiled code: numba types that are LLVM vectors, and the operators on them.

A vector wider than a register is split by LLVM; one of AVX-512 is used where the machine has it.
"""

from __future__ import annotations

import operator
from typing import Any, ClassVar

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import AbstractTemplate, ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

from rockcli.kernels.lanes.vector import WIDTH

DOUBLES = ir.VectorType(ir.DoubleType(), WIDTH)
INTEGERS = ir.VectorType(ir.IntType(64), WIDTH)
BITS = ir.VectorType(ir.IntType(1), WIDTH)


class Vector(types.Type):
    """WIDTH doubles."""

    def __init__(self) -> None:
        super().__init__(name=f"Vector{WIDTH}")


class Mask(types.Type):
    """WIDTH truth values."""

    def __init__(self) -> None:
        super().__init__(name=f"Mask{WIDTH}")


vector, mask = Vector(), Mask()


@register_model(Vector)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, DOUBLES)


@register_model(Mask)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, BITS)


def _is_number(kind: Any) -> bool:
    return isinstance(kind, types.Float | types.Integer)


def _doubles(builder: Any, value: Any, kind: Any) -> Any:
    """A vector as it is; a number in every lane."""
    if kind == vector:
        return value
    if isinstance(kind, types.Integer):
        value = builder.sitofp(value, ir.DoubleType())
    one = builder.insert_element(ir.Constant(DOUBLES, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    lanes = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(one, ir.Constant(DOUBLES, ir.Undefined), lanes)


def _operator(function: Any, result: Any, build: Any) -> None:
    """Teach numba `function(a, b)` where one is a vector, the other a vector or a number."""

    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            if len(args) == 2 and vector in args and all(x == vector or _is_number(x) for x in args):
                return signature(result, *(x if x == vector else types.float64 for x in args))
            return None

    infer_global(function)(Template)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (_doubles(builder, x, kind) for x, kind in zip(args, sig.args, strict=True))
        return build(builder, a, b)

    for pair in ((vector, vector), (vector, types.float64), (types.float64, vector)):
        lower_builtin(function, *pair)(lower)


for _function, _name in (
    (operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv"),
):  # fmt: skip
    _operator(_function, vector, lambda builder, a, b, name=_name: getattr(builder, name)(a, b))
for _function, _sign in (
    (operator.lt, "<"), (operator.le, "<="), (operator.gt, ">"), (operator.ge, ">="), (operator.eq, "=="),
):  # fmt: skip
    _operator(_function, mask, lambda builder, a, b, sign=_sign: builder.fcmp_ordered(sign, a, b))


def _unary(function: Any, kind: Any, build: Any) -> None:
    class Template(ConcreteTemplate):
        cases: ClassVar = [signature(kind, kind)]

    infer_global(function)(Template)
    lower_builtin(function, kind)(lambda context, builder, sig, args: build(builder, args[0]))


def _call(builder: Any, name: str, result: Any, value: Any) -> Any:
    """Call an LLVM intrinsic of one argument."""
    kind = ir.FunctionType(result, [value.type])
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), [value])


_unary(operator.neg, vector, lambda builder, x: builder.fneg(x))
_unary(abs, vector, lambda builder, x: _call(builder, f"llvm.fabs.v{WIDTH}f64", DOUBLES, x))
_unary(operator.invert, mask, lambda builder, x: builder.not_(x))


def _logic(function: Any, name: str) -> None:
    class Template(ConcreteTemplate):
        cases: ClassVar = [signature(mask, mask, mask)]

    infer_global(function)(Template)
    lower_builtin(function, mask, mask)(lambda context, builder, sig, args: getattr(builder, name)(*args))


_logic(operator.and_, "and_")
_logic(operator.or_, "or_")


def _place(context: Any, builder: Any, array_type: Any, array: Any, i: Any) -> Any:
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [i], inbounds=True), DOUBLES.as_pointer())


@intrinsic
def load(typingctx: Any, array: Any, i: Any) -> Any:
    """Elements i ... i + WIDTH - 1 of a contiguous array of floats."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.load(_place(context, builder, sig.args[0], args[0], args[1]), align=8)

    return vector(array, types.intp), codegen


@intrinsic
def store(typingctx: Any, array: Any, i: Any, value: Any) -> Any:
    """Write a vector to elements i ... i + WIDTH - 1 of a contiguous array."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _place(context, builder, sig.args[0], args[0], args[1]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), codegen


@intrinsic
def spread(typingctx: Any, x: Any) -> Any:
    """A number in every lane."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _doubles(builder, args[0], sig.args[0])

    return vector(types.float64), codegen


@intrinsic
def select(typingctx: Any, where: Any, a: Any, b: Any) -> Any:
    """a where it is so, else b; either may be a number."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (_doubles(builder, x, kind) for x, kind in zip(args[1:], sig.args[1:], strict=True))
        return builder.select(args[0], a, b)

    return vector(mask, *(x if x == vector else types.float64 for x in (a, b))), codegen


@intrinsic
def some(typingctx: Any, where: Any) -> Any:
    """Whether it is so in any lane."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _call(builder, f"llvm.vector.reduce.or.v{WIDTH}i1", ir.IntType(1), args[0])

    return types.boolean(mask), codegen


@intrinsic
def sqrt(typingctx: Any, x: Any) -> Any:
    """Square root, rounded correctly."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _call(builder, f"llvm.sqrt.v{WIDTH}f64", DOUBLES, args[0])

    return vector(vector), codegen


@intrinsic
def fma(typingctx: Any, a: Any, b: Any, c: Any) -> Any:
    """a b + c rounded once, the same bits on every machine; each a vector or a number."""
    some_vector = vector in (a, b, c)
    result = vector if some_vector else types.float64

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        numbers, kind, name = args, ir.DoubleType(), "llvm.fma.f64"
        if some_vector:
            numbers = [_doubles(builder, x, of) for x, of in zip(args, sig.args, strict=True)]
            kind, name = DOUBLES, f"llvm.fma.v{WIDTH}f64"
        fused = cgutils.get_or_insert_function(builder.module, ir.FunctionType(kind, [kind] * 3), name)
        return builder.call(fused, numbers)

    return result(*(x if x == vector else types.float64 for x in (a, b, c))), codegen


@intrinsic
def bits_of(typingctx: Any, x: Any) -> Any:
    """The bits of each number read as an integer, as a float."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.sitofp(builder.bitcast(args[0], INTEGERS), DOUBLES)

    return vector(vector), codegen


@intrinsic
def from_bits(typingctx: Any, x: Any) -> Any:
    """The number whose bits, read as an integer, are x cut to an integer."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.bitcast(builder.fptosi(args[0], INTEGERS), DOUBLES)

    return vector(vector), codegen


@intrinsic
def gather(typingctx: Any, array: Any, index: Any, offset: Any) -> Any:
    """The elements of a contiguous array so far behind those that a vector of whole numbers names."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        value = ir.Constant(DOUBLES, ir.Undefined)
        for lane in range(WIDTH):
            place = ir.Constant(ir.IntType(32), lane)
            at = builder.fptosi(builder.extract_element(args[1], place), ir.IntType(64))  # of several gathers once
            at = builder.add(at, args[2])
            value = builder.insert_element(value, builder.load(builder.gep(data, [at], inbounds=True)), place)
        return value

    return vector(array, vector, types.intp), codegen


@intrinsic
def fetch(typingctx: Any, array: Any, i: Any) -> Any:
    """Have the memory of element i of a contiguous array brought near before it is used."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        place = builder.bitcast(builder.gep(data, [args[1]], inbounds=True), ir.IntType(8).as_pointer())
        word = ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [place.type, word, word, word])
        near = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        builder.call(near, [place, *(ir.Constant(word, x) for x in (0, 3, 1))])
        return context.get_dummy_value()

    return types.void(array, types.intp), codegen


@intrinsic
def note(typingctx: Any, where: Any, first: Any, array: Any, n: Any) -> Any:
    """Append first + lane to array[n], array[n + 1], ... for the lanes where it is so; the new n."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        lanes = ir.Constant(DOUBLES, [float(i) for i in range(WIDTH)])
        numbers = builder.fadd(_doubles(builder, args[1], sig.args[1]), lanes)
        data = context.make_array(sig.args[2])(context, builder, args[2]).data
        place = builder.gep(data, [args[3]], inbounds=True)
        kind = ir.FunctionType(ir.VoidType(), [DOUBLES, place.type, BITS])
        name = f"llvm.masked.compressstore.v{WIDTH}f64"
        builder.call(cgutils.get_or_insert_function(builder.module, kind, name), [numbers, place, args[0]])
        bits = builder.bitcast(args[0], ir.IntType(WIDTH))
        return builder.add(args[3], builder.zext(builder.ctpop(bits), ir.IntType(64)))

    return types.intp(mask, types.float64, array, types.intp), codegen
