"""SIMD kernels, written by hand: products with blocks of eight columns.

The compiler does not vectorize a loop over eight numbers, and tests for overlapping arrays before a loop over
a few rows. Factors of narrow bands have only such loops. So these few loops are written as operations on
eight numbers at once. Arrays are in C order, and are passed with the index of their first number; blocks are
stored column by column. Numbers of rows are multiples of eight.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic

#: Number of columns of a block, and of entries of a vector.
COLUMNS = 8
# products and sums may be fused and reordered, as in loops that the compiler vectorizes
_FLAGS = ("contract", "reassoc", "nsz")


class _Writer:
    """Writes operations on vectors of numbers of one kind."""

    def __init__(self, context: Any, builder: Any, kind: Any) -> None:
        self._context, self._builder = context, builder
        scalar = context.get_value_type(kind)
        self._vector = ir.VectorType(scalar, COLUMNS)
        self._bytes = kind.bitwidth // 8

    def data(self, array: Any, value: Any) -> Any:
        """Return the pointer to the first entry of an array."""
        return self._context.make_array(array)(self._context, self._builder, value).data

    def load(self, data: Any, place: Any) -> Any:
        """Return a vector of entries of an array."""
        return self._builder.load(self._pointer(data, place), align=self._bytes)

    def store(self, vector: Any, data: Any, place: Any) -> None:
        """Set a part of an array to a vector."""
        self._builder.store(vector, self._pointer(data, place), align=self._bytes)

    def _pointer(self, data: Any, place: Any) -> Any:
        return self._builder.bitcast(self._builder.gep(data, [place]), self._vector.as_pointer())

    @property
    def zero(self) -> Any:
        """Return a vector of zeros."""
        return ir.Constant(self._vector, [0.0] * COLUMNS)

    def variable(self, vector: Any) -> Any:
        """Return a variable for a vector that changes in a loop, set to another vector."""
        kept = cgutils.alloca_once(self._builder, self._vector)  # type: ignore[no-untyped-call]
        self._builder.store(vector, kept)
        return kept

    def all_of(self, scalar: Any) -> Any:
        """Return a vector of one number."""
        first = self._builder.insert_element(self.zero, scalar, ir.IntType(32)(0))
        return self._shuffled(first, first, [0] * COLUMNS)

    def each_of(self, vector: Any) -> list[Any]:
        """Return, for each entry of a vector, a vector of this number."""
        return [self._shuffled(vector, vector, [k] * COLUMNS) for k in range(COLUMNS)]

    def _shuffled(self, one: Any, other: Any, places: list[int]) -> Any:
        mask = ir.Constant(ir.VectorType(ir.IntType(32), COLUMNS), places)
        return self._builder.shuffle_vector(one, other, mask)

    def plus(self, one: Any, other: Any) -> Any:
        """Return their sum."""
        return self._builder.fadd(one, other, flags=_FLAGS)

    def minus(self, one: Any, other: Any) -> Any:
        """Return their difference."""
        return self._builder.fsub(one, other, flags=_FLAGS)

    def times(self, one: Any, other: Any) -> Any:
        """Return their products, entry by entry."""
        return self._builder.fmul(one, other, flags=_FLAGS)

    def sum_of_products(self, ones: list[Any], others: list[Any]) -> Any:
        """Return the sum of products over pairs of vectors, in two independent halves."""
        products = [self.times(one, other) for one, other in zip(ones, others, strict=True)]
        halves = products[:2]
        for k, product in enumerate(products[2:]):
            halves[k % 2] = self.plus(halves[k % 2], product)
        return self.plus(*halves)

    def sums(self, vectors: list[Any]) -> Any:
        """Return the sums of eight vectors, as the entries of one vector."""
        while len(vectors) > 1:
            # a vector has one partial sum for each vector that was added to it, periodically
            size = COLUMNS // len(vectors)
            firsts = [k + array for k in range(0, COLUMNS, 2 * size) for array in (0, COLUMNS)]
            one = [k for first in firsts for k in range(first, first + size)]
            other = [k + size for k in one]
            vectors = [
                self.plus(self._shuffled(a, b, one), self._shuffled(a, b, other))
                for a, b in zip(vectors[::2], vectors[1::2], strict=True)
            ]
        return vectors[0]


def _check(*arrays: Any) -> None:
    """Raise TypingError unless the arrays have one type of numbers, and are in C order."""
    if len({array.dtype for array in arrays}) > 1 or any(array.layout != "C" for array in arrays):
        raise TypingError(f"arrays must be of one kind, and in C order, not {arrays}")


def _number(value: int) -> Any:
    return ir.IntType(64)(value)


@intrinsic
def forward(_context: Any, values: Any, _block: Any, _rows: Any, x: Any, _start: Any) -> Any:
    """Solve with a block of a triangular factor, in place: for the entries of x from the start on.

    From the index `block` on, the values are the inverse (8, 8) of its triangle and its columns (8, rows)
    below.
    """

    _check(values, x)

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        write = _Writer(context, builder, signature.args[0].dtype)
        values, x = write.data(signature.args[0], arguments[0]), write.data(signature.args[3], arguments[3])
        _, block, rows, _, start = arguments
        inverse = [write.load(values, builder.add(block, _number(c * COLUMNS))) for c in range(COLUMNS)]
        solved = write.sum_of_products(inverse, write.each_of(write.load(x, start)))
        write.store(solved, x, start)
        parts = write.each_of(solved)
        columns, below = _below(builder, block, rows, start)
        with cgutils.for_range(builder, builder.udiv(rows, _number(COLUMNS))) as loop:
            offset = builder.mul(loop.index, _number(COLUMNS))
            taken = [write.load(values, builder.add(column, offset)) for column in columns]
            place = builder.add(below, offset)
            rest = write.minus(write.load(x, place), write.sum_of_products(taken, parts))
            write.store(rest, x, place)
        return context.get_dummy_value()

    return types.void(values, types.int64, types.int64, x, types.int64), code


@intrinsic
def backward(_context: Any, values: Any, _block: Any, _rows: Any, x: Any, _start: Any) -> Any:
    """Return the same with the transposed factor."""

    _check(values, x)

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        write = _Writer(context, builder, signature.args[0].dtype)
        values, x = write.data(signature.args[0], arguments[0]), write.data(signature.args[3], arguments[3])
        _, block, rows, _, start = arguments
        columns, below = _below(builder, block, rows, start)
        totals = [write.variable(write.zero) for _ in columns]
        with cgutils.for_range(builder, builder.udiv(rows, _number(COLUMNS))) as loop:
            offset = builder.mul(loop.index, _number(COLUMNS))
            known = write.load(x, builder.add(below, offset))
            for column, total in zip(columns, totals, strict=True):
                product = write.times(write.load(values, builder.add(column, offset)), known)
                builder.store(write.plus(builder.load(total), product), total)
        rest = write.minus(write.load(x, start), write.sums([builder.load(total) for total in totals]))
        inverse = [write.load(values, builder.add(block, _number(c * COLUMNS))) for c in range(COLUMNS)]
        write.store(write.sums([write.times(column, rest) for column in inverse]), x, start)
        return context.get_dummy_value()

    return types.void(values, types.int64, types.int64, x, types.int64), code


def _below(builder: Any, block: Any, rows: Any, start: Any) -> tuple[list[Any], Any]:
    """Return the index of the columns below a block, and that of the entries of x that they multiply."""
    first = builder.add(block, _number(COLUMNS * COLUMNS))
    columns = [builder.add(first, builder.mul(rows, _number(c))) for c in range(COLUMNS)]
    return columns, builder.add(start, _number(COLUMNS))


def _product(*, subtract: bool) -> Any:
    @intrinsic
    def multiplied(
        _context: Any,
        left: Any,
        _first: Any,
        _stride: Any,
        right: Any,
        _right_first: Any,
        _right_stride: Any,
        result: Any,
        _result_first: Any,
        _result_stride: Any,
        _rows: Any,
    ) -> Any:
        _check(left, right, result)

        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            write = _Writer(context, builder, signature.args[0].dtype)

            def columns(argument: int) -> tuple[Any, list[Any]]:
                """Return the start of an array, and the indices of the columns that it is passed with."""
                array, first, stride = arguments[argument : argument + 3]
                places = [builder.add(first, builder.mul(stride, _number(k))) for k in range(COLUMNS)]
                return write.data(signature.args[argument], array), places

            (left, lefts), (right, rights), (result, results) = columns(0), columns(3), columns(6)
            with cgutils.for_range(builder, builder.udiv(arguments[9], _number(COLUMNS))) as loop:
                offset = builder.mul(loop.index, _number(COLUMNS))
                ones = [write.load(left, builder.add(place, offset)) for place in lefts]
                for c, result_place in enumerate(results):
                    places = [builder.add(place, _number(c)) for place in rights]
                    others = [write.all_of(builder.load(builder.gep(right, [place]))) for place in places]
                    total, place = write.sum_of_products(ones, others), builder.add(result_place, offset)
                    if subtract:
                        total = write.minus(write.load(result, place), total)
                    write.store(total, result, place)
            return context.get_dummy_value()

        arrays = (kind for array in (left, right, result) for kind in (array, types.int64, types.int64))
        return types.void(*arrays, types.int64), code

    return multiplied


#: Set columns (8, rows) to a product: column c is the sum over k of column k of a left block (8, rows) times
#: entry c of column k of a right one (8, 8). The arguments are, for left, right and result, the array, the
#: index of its first entry, and the stride of columns; and then the number of rows.
set_product = _product(subtract=False)
#: The same product, subtracted.
take_off_product = _product(subtract=True)
