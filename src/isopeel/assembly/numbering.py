"""The order of the unknowns, for a narrow band: by place, or by neighbours."""

from collections.abc import Sequence

import numpy as np

from isopeel.assembly.spaces import HELD
from isopeel.common.arrays import FloatArray, IntArray


def number_by_place(groups: IntArray, places: FloatArray, axis: int) -> IntArray:
    """Number the groups by the place of their functions, along one axis first, then along the other."""
    place = np.repeat(places, 2, axis=0)
    component = np.tile([0, 1], len(places))
    flat = groups.ravel()
    order = np.lexsort((component, place[:, 1 - axis], place[:, axis]))
    order = order[flat[order] != HELD]
    # a group is numbered where its last member stands, next to the functions it is coupled with
    last_first = order[::-1]
    _, first = np.unique(flat[last_first], return_index=True)
    members = np.sort(len(order) - 1 - first)
    numbers = np.full(flat.size, HELD)
    numbers[flat[order[members]]] = np.arange(len(members))
    numbered: IntArray = np.where(flat == HELD, HELD, numbers[flat]).reshape(groups.shape)
    return numbered


def number_by_neighbours(groups: IntArray, elements: Sequence[IntArray]) -> IntArray:
    """Number the groups (size, 2) by the reverse algorithm of Cuthill and McKee."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    known, compact = np.unique(groups, return_inverse=True)
    compact = compact.reshape(groups.shape) - int(known[0] == HELD)
    count = int(compact.max()) + 1
    pairs = []
    for functions in elements:
        members = compact[functions].reshape(len(functions), -1)
        size = members.shape[1]
        rows, columns = np.repeat(members, size, axis=1), np.tile(members, size)
        free = (rows != HELD) & (columns != HELD)
        pairs.append(np.stack([rows[free], columns[free]]))
    places = np.concatenate(pairs, axis=1)
    graph = coo_array((np.ones(places.shape[1]), tuple(places)), (count, count)).tocsr()
    order = reverse_cuthill_mckee(graph, symmetric_mode=True)
    numbers = np.append(np.empty(count, dtype=np.int64), HELD)
    numbers[order] = np.arange(count)
    numbered: IntArray = numbers[compact]
    return numbered


def half_bandwidth(unknowns: IntArray, elements: Sequence[IntArray]) -> int:
    """Largest distance of two unknowns of one element, for arrays (E, m) of the elements' functions."""
    widest = 0
    for functions in elements:
        numbers = unknowns[functions].reshape(len(functions), -1)
        highest = numbers.max(axis=1)
        lowest = np.where(numbers == HELD, highest[:, None], numbers).min(axis=1)
        widest = max(widest, int((highest - lowest).max()))
    return widest
