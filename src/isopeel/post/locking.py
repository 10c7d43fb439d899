"""Locking: a discretized body that is stiffer in bending, or at constant volume, than its material.

The stiffness of a few elements of the actual space in pure bending is compared with the exact one. For a
nearly incompressible body the error of bending to the curvature of the peeling front is added.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import block_array, csr_array, kron

from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.common.arrays import FloatArray
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form import expected
from isopeel.post.driven import driven_on
from isopeel.post.laboratory import Laboratory
from isopeel.post.resolution import body_height, compliant, is_held, lies_flat
from isopeel.problem import Boundary, Constraint, Problem, RotatedSide
from isopeel.results.notes import Note, Remedy
from isopeel.splines.names import parse_space_name
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.rows import RowSpace
from isopeel.splines.space import SplineSpace

#: Error of the drive's reaction above which a note is written: less than the 3 % within which a run must be
#: right, and more than the error of closed forms of slender bodies.
LOCKED = 0.02
#: Ratio of length and height above which a body deforms by bending.
_SLENDER = 4.0
#: Sides along the length of a strip.
_ALONG: tuple[Side, ...] = ("bottom", "top")
#: Number of element columns that are bent: two have no inner one, and more bend like four.
_COLUMNS = 4
#: The force of steady peeling of a tape does not depend on its bending; its start and its stresses do.
_TAPE = 0.1
#: Poisson's ratio above which a body is nearly incompressible.
_COMPRESSIBLE = 0.45
#: Degree across above which more elements help more than a higher degree.
_ENOUGH = 3
#: Most functions of a block that is pulled to check whether it locks; it takes some ten milliseconds.
_MOST_FUNCTIONS = 1000
# K/E (height x curvature)^2 / (elements across)^4 times this is what degree 2 across adds to the bending
# stiffness: 7.3 % measured at nu = 0.499 of a strip bent to 15 heights with one element, 0.5 % with two
# (`benchmarks/locking.py`)
_QUADRATIC_VOLUME = 0.1


@dataclass(frozen=True)
class Bending:
    """Excess of the bending stiffness of a discretization, relative to E'I."""

    linear: float  # at small curvature, from the functions
    volume: float  # at the curvature of the front, from the change of volume that degree 2 leaves

    @property
    def excess(self) -> float:
        """Of both."""
        return self.linear + self.volume


def bending(problem: Problem, space: RowSpace, interface: str = "") -> Bending | None:
    """Return the excess of the bending stiffness of a body on a space; None if it is thick or kept flat.

    The body is that of the only interface, or of a named one. The excess is the mean over its length under a
    uniform moment.
    """
    name = problem.interface_of(interface).boundary.body
    body = problem.body_of(name)
    lengths, heights = _sizes(body.shape, space)
    along = {one.side for one in driven_on(problem, name)} & {"bottom", "top"}
    moved_flat = isinstance(problem.drive, Constraint) and bool(along)
    held_flat = len(problem.bodies) > 1 and any(is_held(problem, name, side) for side in _ALONG)
    if lengths.sum() < _SLENDER * heights.mean() or moved_flat or held_flat:
        return None
    nu = body.material.poissons_ratio
    linear = _linear(space, lengths, heights, nu)
    if space.across.degree != 2:
        return Bending(linear, 0.0)
    modulus = plane_strain_modulus(body.material)
    work = _work_of_bending(problem, interface)
    # W = E'I/(2 R^2) at the front of a strip that a moment peels; h/R is below 1 where strains are
    bent = np.minimum(24 * work / (modulus * heights.mean()), 1.0)
    parts = np.diff(space.across.breakpoints) ** 5
    volume = _QUADRATIC_VOLUME * bent * float(parts.sum()) / (3 * (1 - 2 * nu))
    return Bending(linear, volume)


def _work_of_bending(problem: Problem, interface: str) -> float:
    """Return the part of the work of adhesion that one of two bodies releases where equal moments bend them.

    Their energies are as their compliances in bending, 1/(E'I).
    """
    adhesion = problem.interface_of(interface)
    work = adhesion.law.work_of_adhesion
    if not isinstance(adhesion.against, Boundary):
        return work
    modulus = plane_strain_modulus(problem.body_of(adhesion.boundary.body).material)
    both, height = compliant(problem, interface)
    return work * both * height**3 / (modulus * body_height(problem, interface) ** 3)


def locking_notes(
    problem: Problem, space: SpaceOfBodies, laboratory: Laboratory, *, bends: bool = True
) -> list[Note]:
    """Return notes on how much too stiff the body is, if this affects the reaction, and on a remedy.

    `bends` is whether the values read from the run depend on the bending of the body. Several bodies have
    notes each, with their names.
    """
    spaces, notes = spaces_by_name(problem, space), list[Note]()
    for name, one in zip(problem.interface_names, problem.faces, strict=True):
        own = spaces[one.boundary.body]
        found = _bending_notes(problem, own, laboratory, name) if bends else []
        found += _volume_notes(problem, spaces, name)
        notes += [note for note in found if note not in notes]
    return notes


def confined(problem: Problem, spaces: SpaceOfBodies, interface: str = "") -> float | None:
    """Return the excess of stiffness of a nearly incompressible body that lies flat and is pulled.

    It is that of a block with both sides held: the stiffness in this space over that with one degree more in
    both directions, minus the same at a Poisson's ratio of 0.3, because corners are not resolved for any
    material. Large spaces are coarsened; the error is assumed to be inversely proportional to the number of
    elements. Returns None for other bodies.
    """
    boundary = problem.interface_of(interface).boundary
    body = problem.body_of(boundary.body)
    nu = body.material.poissons_ratio
    drive = problem.driven_side if driven_on(problem, body.name) else None
    if (
        nu <= _COMPRESSIBLE
        or {drive, boundary.side} != {"bottom", "top"}
        or not lies_flat(problem, spaces, interface)
    ):
        return None
    space = spaces_by_name(problem, spaces)[body.name]
    lengths, heights = _sizes(body.shape, space)
    aspect = float(lengths.sum() / heights.mean())
    step = 1
    while (coarse := _coarser(space, step)).size > _MOST_FUNCTIONS:
        step += 1
    fine = _block_stiffness(_richer_both_ways(coarse), aspect, (nu, 0.3))
    rough = _block_stiffness(coarse, aspect, (nu, 0.3))
    return max(rough[0] / fine[0] - rough[1] / fine[1], 0.0) / step


def _volume_notes(problem: Problem, spaces: SpaceOfBodies, interface: str) -> list[Note]:
    found = confined(problem, spaces, interface)
    if found is None or found <= LOCKED:
        return []
    name = problem.interface_of(interface).boundary.body
    material, space = problem.body_of(name).material, spaces_by_name(problem, spaces)[name]
    degree, body = space.across.degree, _body_in_words(problem, interface)
    higher = f" and across_degree = {degree + 1}" if degree < _ENOUGH else ""
    text = (
        f"volume: the {body}, whose Poisson's ratio is {material.poissons_ratio:g}, is at least "
        f"{_by(found)} too stiff next to the sides that hold it; use more elements in both directions{higher}"
    )
    finer = Remedy((2 * space.elements[0], 2 * space.elements[1]))
    return [Note("locking", text, finer if len(problem.bodies) == 1 else None)]


def _coarser(space: RowSpace, step: int) -> RowSpace:
    """Return the space on every `step`-th breakpoint in both directions."""

    def thinned(one: SplineSpace) -> SplineSpace:
        ends = np.append(one.breakpoints[:-1:step], one.breakpoints[-1])
        return SplineSpace.on(one.degree, int(one.continuities.max(initial=0)), ends)

    return _with_spaces(space, thinned)


def _richer_both_ways(space: RowSpace) -> RowSpace:
    """Return the space with one degree more along, and across, and the continuity that it has."""

    def elevated(one: SplineSpace) -> SplineSpace:
        return SplineSpace.on(one.degree + 1, int(one.continuities.max(initial=0)), one.breakpoints)

    return _with_spaces(space, elevated)


def _with_spaces(space: RowSpace, change: Callable[[SplineSpace], SplineSpace]) -> RowSpace:
    """Return the space with its univariate spaces changed; the first rows keep their kind."""
    across, changed = change(space.across), {row: change(row) for row in dict.fromkeys(space.rows)}
    bulk = space.rows[-1]
    first = [row for row in space.rows if row is not bulk][: across.size]
    rows = [*first, *[bulk] * (across.size - len(first))]
    return RowSpace(space.name, across, tuple(changed[row] for row in rows))


def _block_stiffness(space: RowSpace, aspect: float, poissons_ratios: Sequence[float]) -> list[float]:
    """Return stiffnesses of a block `aspect` times as long as high, lower and upper side held; E = 1."""
    from scipy.sparse.linalg import spsolve

    long = {row: SplineSpace(row.degree, row.knot_vector * aspect) for row in dict.fromkeys(space.rows)}
    block = replace(space, rows=tuple(long[row] for row in space.rows), weights=None)
    of_volume, of_shear, size = _stiffness(block, 1.0, 0.0), _stiffness(block, 0.0, 1.0), block.size
    held = np.concatenate([block.side_functions("bottom"), block.side_functions("top")])
    held = np.concatenate([held, size + held])
    free = np.setdiff1d(np.arange(2 * size), held)
    found = []
    for ratio in poissons_ratios:
        shear = 1 / (2 * (1 + ratio))
        stiffness = csr_array(2 * shear * ratio / (1 - 2 * ratio) * of_volume + shear * of_shear)
        moved = np.zeros(2 * size)
        moved[size + block.side_functions("top")] = 1.0
        moved[free] = spsolve(stiffness[free][:, free].tocsc(), -(stiffness @ moved)[free])
        found.append(float(moved @ (stiffness @ moved)))
    return found


def _bending_notes(problem: Problem, space: RowSpace, laboratory: Laboratory, interface: str) -> list[Note]:
    found = bending(problem, space, interface)
    if found is None or not _matters(problem, space, found):
        return []
    shape = problem.body_of(problem.interface_of(interface).boundary.body).shape
    along, across = (laboratory.text(size, "length", 3) for size in _largest(shape, space))
    message = (
        f"bending: the {_body_in_words(problem, interface)} is {_by(found.excess)} too stiff on elements of "
        f"{along} x {across} (space {space.name}, degree {space.across.degree} across)"
    )
    for richer, words in _richer(space):
        better = bending(problem, richer, interface)
        if better is not None and not _matters(problem, richer, better):
            return [Note("locking", f"{message}; {words} is sufficient ({_by(better.excess)})")]
    return [Note("locking", f"{message}; use smaller elements and space N2.1 with across_degree = 3")]


def _body_in_words(problem: Problem, interface: str) -> str:
    name = problem.interface_of(interface).boundary.body
    return "body" if len(problem.bodies) == 1 else f"body {name}"


def _by(excess: float) -> str:
    """Return an excess in words."""
    return f"{100 * excess:.1f} %" if excess < 1 else f"{1 + excess:.2g} times"


def _matters(problem: Problem, space: RowSpace, found: Bending) -> bool:
    """Return whether an excess of the bending stiffness makes the reaction wrong."""
    power, allowed = 1.0, LOCKED
    if isinstance(problem.drive, RotatedSide):
        power = 0.5  # M = sqrt(2 E'I W)
    elif expected(problem, space) is not None:
        allowed = _TAPE
    return bool((1 + found.excess) ** power - 1 > allowed)


def _richer(space: RowSpace) -> Iterator[tuple[RowSpace, str]]:
    """Yield spaces on the same elements that lock less, with their keys in a case."""
    degree = space.across.degree
    curved = min(row.degree for row in space.rows) < 2
    for across in dict.fromkeys((degree, max(degree, 2), max(degree, 3))):
        for name in (space.name, "N2.1") if curved else (space.name,):
            words = [f"across_degree = {across}"] if across != degree else []
            words += [f"space {name}"] if name != space.name else []
            if words:
                yield _on_the_same_elements(space, name, across), " with ".join(words)


def _on_the_same_elements(space: RowSpace, name: str, across_degree: int) -> RowSpace:
    parsed = parse_space_name(name)
    across = SplineSpace.on(across_degree, across_degree - 1, space.across.breakpoints)
    contact, bulk = (
        SplineSpace.on(family.degree, family.continuity, space.rows[0].breakpoints)
        for family in (parsed.contact, parsed.bulk)
    )
    at_contact = min(parsed.contact_rows, across.size)
    return RowSpace(name, across, (contact,) * at_contact + (bulk,) * (across.size - at_contact))


def _sizes(shape: NurbsSurface, space: RowSpace) -> tuple[FloatArray, FloatArray]:
    """Return length and height (elements,) of a body at its elements along xi."""
    ends = space.rows[0].breakpoints
    middle = (shape.evaluate(ends, 0.0) + shape.evaluate(ends, 1.0)) / 2
    at = (ends[1:] + ends[:-1]) / 2
    through = shape.evaluate(at, 1.0) - shape.evaluate(at, 0.0)
    return np.linalg.norm(np.diff(middle, axis=0), axis=1), np.linalg.norm(through, axis=1)


def _largest(shape: NurbsSurface, space: RowSpace) -> tuple[float, float]:
    """Return length and height of the longest element."""
    lengths, heights = _sizes(shape, space)
    at = int(np.argmax(lengths))
    return float(lengths[at]), float(heights[at] * np.diff(space.across.breakpoints).max())


def _linear(space: RowSpace, lengths: FloatArray, heights: FloatArray, poissons_ratio: float) -> float:
    """Return the mean excess of the bending stiffness of elements (elements,) at small strain."""
    # the exact deflection is quadratic in both directions, so degree 2 in both directions represents it
    if space.across.degree >= 2 and min(row.degree for row in space.rows) >= 2:
        return 0.0
    order = np.argsort(lengths / heights)
    share = np.cumsum(lengths[order]) / lengths.sum()
    # the excess is a smooth function of the aspect: a few quantiles are enough
    aspects = np.interp([0.1, 0.3, 0.5, 0.7, 0.9], share, (lengths / heights)[order])
    even = np.ptp(aspects) < 1e-6 * aspects[0]
    stiffness = [1 + _excess_of_columns(space, a, poissons_ratio) for a in (aspects[:1] if even else aspects)]
    return float(1 / np.mean(1 / np.array(stiffness))) - 1


def _excess_of_columns(space: RowSpace, aspect: float, poissons_ratio: float) -> float:
    """Return the excess of the bending stiffness of equal columns, `aspect` times as long as high; E = 1.

    Plane strain. The exact field of pure bending is u = curvature (-x y, x^2/2 + nu/(1 - nu) y^2/2), with
    an energy E'I/2 curvature^2 per length; the columns have its horizontal displacement at both ends.
    """
    from scipy.sparse.linalg import spsolve

    ends = aspect * np.arange(_COLUMNS + 1.0)
    rows = {
        row: SplineSpace.on(row.degree, int(row.continuities.max(initial=0)), ends)
        for row in dict.fromkeys(space.rows)
    }
    columns = replace(
        space,
        rows=tuple(rows[row] for row in space.rows),
        weights=None,
    )
    shear = 1 / (2 * (1 + poissons_ratio))
    lame = 2 * shear * poissons_ratio / (1 - 2 * poissons_ratio)
    stiffness = _stiffness(columns, lame, shear)
    size = columns.size
    # horizontal displacement at the ends: a rotation about the middle
    turned = columns.across.interpolate(columns.across.greville - 0.5)
    given = np.zeros(2 * size)
    left, right = columns.side_functions("left"), columns.side_functions("right")
    given[right] = -turned
    # one point is held vertically
    held = np.concatenate([left, right, [size + int(left[0])]])
    free = np.setdiff1d(np.arange(2 * size), held)
    forces = stiffness @ given
    given[free] = spsolve(stiffness[free][:, free].tocsc(), -forces[free])
    energy = float(given @ (stiffness @ given)) / 2
    exact = 1 / float(ends[-1]) / 24 / (1 - poissons_ratio**2)
    return float(energy / exact - 1)


def _stiffness(space: RowSpace, lame: float, shear: float) -> csr_array:
    """Return the stiffness (2 size, 2 size) in plane strain for height 1, horizontal components first."""
    families = list(dict.fromkeys(space.rows))
    along = {
        (a, b, i, j): _products(one, other, i, j)
        for a, one in enumerate(families)
        for b, other in enumerate(families)
        for i in range(2)
        for j in range(2)
    }
    across = {
        (i, j): _products(space.across, space.across, i, j).toarray() for i in range(2) for j in range(2)
    }
    kinds = [families.index(row) for row in space.rows]

    def block(i: int, j: int, k: int, m: int) -> csr_array:
        """Return int d^i N d^k M . d^j N d^m M, of derivatives along and across of both functions."""
        table = across[k, m]
        if len(families) == 1:
            return csr_array(kron(table, along[0, 0, i, j]))
        parts = [
            [along[a, b, i, j] * table[r, c] if table[r, c] else None for c, b in enumerate(kinds)]
            for r, a in enumerate(kinds)
        ]
        return csr_array(block_array(parts))

    stiff = lame + 2 * shear
    horizontal = stiff * block(1, 1, 0, 0) + shear * block(0, 0, 1, 1)
    vertical = stiff * block(0, 0, 1, 1) + shear * block(1, 1, 0, 0)
    coupling = lame * block(1, 0, 0, 1) + shear * block(0, 1, 1, 0)
    return csr_array(block_array([[horizontal, coupling], [coupling.T, vertical]]))


def _products(one: SplineSpace, other: SplineSpace, i: int, j: int) -> csr_array:
    """Return integrals (size, other size) of derivatives of order i and j of the functions of two spaces."""
    nodes, weights = np.polynomial.legendre.leggauss(max(one.degree, other.degree) + 1)
    half = np.diff(one.breakpoints)[:, None] / 2
    points = (one.breakpoints[:-1, None] + half * (nodes + 1)).ravel()
    values = one.collocation(points, i).multiply((half * weights).ravel()[:, None])
    return csr_array(values.T @ other.collocation(points, j))
