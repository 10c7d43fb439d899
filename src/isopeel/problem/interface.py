"""An interface of a body: the law, what it acts against, and how it is integrated."""

from dataclasses import dataclass, replace
from typing import Literal, get_args

from isopeel.common.errors import InputError
from isopeel.physics.adhesion import AdhesionLaw, Contact
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.joints import HistoryVariable, JointLaw
from isopeel.physics.substrates import Substrate
from isopeel.problem.boundary import Boundary
from isopeel.splines.nurbs import Side

#: Area that the adhesive traction acts on: the reference area, or its projection on the substrate.
Traction = Literal["reference", "projected"]

#: Which sides of an interface between two bodies are integrated, and what the forces act on: both sides by
#: halves, with one energy; the first side alone; or each side for the forces on itself alone.
Scheme = Literal["unbiased", "biased", "two-half-pass"]

#: The history of an interface with a law of the gap.
MAXIMUM_OPENING = HistoryVariable(
    "maximum_openings",
    "L0",
    "maximum opening so far at the Gauss points, -1 where it has not closed yet",
)

#: The history of contact with multipliers.
REPLACED_OVERLAP = HistoryVariable(
    "replaced_overlaps",
    "L0",
    "overlap that the multipliers replace at the Gauss points: the pressure over the stiffness",
)


@dataclass(frozen=True)
class Interface:
    """A boundary that a substrate attracts, or the side of another body (plane strain).

    Against a substrate, the force on the body is F_c = -int N^T T n_o dA per reference area dA (`reference`;
    it has a potential), or the same with dA projected on the substrate, times -n_o . F^-T N_o (`projected`;
    its tangent is not symmetric), with the substrate's normal n_o and the outward normal N_o of the side
    (Sadhana 46:3, 2021, Eq. 19, read in two ways). An `irreversible` interface that has opened closes again
    along the secant of the law (`physics.adhesion.irreversible`). Without a `sliding_length` the body slides
    along the substrate without friction; with one it is held along the substrate too
    (`physics.adhesion.sliding`).

    Against another body, the law acts over the gap g of each point to the closest point of the whole other
    side, with the scheme of the integrals over the reference areas A and B of both boundaries:

        unbiased       1/2 int_A Phi(g) dA + 1/2 int_B Phi(g) dB
        biased         int_A Phi(g) dA
        two-half-pass  each boundary is integrated and loads its own body only; there is no potential
                       (Sauer and De Lorenzis, Comput. Methods Appl. Mech. Eng. 253, 2013)

    `smoothed` finds closest points on a smooth curve through the nodes of the other side, where that consists
    of Lagrange elements (`assembly.smoothed_curve`). The points of its own side stay where they are.

    With a joint law (`physics.joints`) the points of the boundary are paired once with the closest points of
    the undeformed other side, and the energy is the integral of the law over the boundary. The jump of a pair
    is its distance x - y less the one at the start, along the mean direction t of both faces and the normal
    n to it: d_n = (x - y) . n - d_n0, d_t = (x - y) . t - d_t0.
    """

    boundary: Boundary
    law: AdhesionLaw
    against: Substrate | Boundary
    traction: Traction = "reference"
    irreversible: bool = False
    sliding_length: float | None = None
    scheme: Scheme = "unbiased"
    smoothed: bool = False

    def __post_init__(self) -> None:
        """Check the kind of traction and the sliding length."""
        if self.traction not in get_args(Traction):
            raise InputError(
                "adhesion.traction", self.traction, f"it must be {' or '.join(get_args(Traction))}"
            )
        if self.scheme not in get_args(Scheme):
            raise InputError("scheme", self.scheme, f"it must be {', '.join(get_args(Scheme))}")
        if isinstance(self.against, Boundary):
            if self.against.body == self.boundary.body:
                raise InputError("against", self.against.body, "it must be the side of another body")
            if self.traction != "reference":
                raise InputError("adhesion.traction", self.traction, "between bodies it must be 'reference'")
            if self.sliding_length is not None:
                allowed = "between bodies a joint law resists sliding, such as 'mixed-mode-bilinear'"
                raise InputError("adhesion.sliding_length", self.sliding_length, allowed)
        if self.smoothed and (isinstance(self.law, JointLaw) or not isinstance(self.against, Boundary)):
            allowed = "it smooths the side of another body, on which a law of the gap finds closest points"
            raise InputError("adhesion.smoothed", True, allowed)
        if isinstance(self.law, Contact) and (self.irreversible or self.sliding_length is not None):
            field = "irreversible" if self.irreversible else "sliding_length"
            allowed = "contact without adhesion has no joint that could be damaged or hold; leave it out"
            raise InputError(f"adhesion.{field}", getattr(self, field), allowed)
        if isinstance(self.law, JointLaw):
            self._check_joint(self.law)
        if self.sliding_length is None:
            return
        if not 0 < self.sliding_length < float("inf"):
            raise InputError("adhesion.sliding_length", self.sliding_length, "it must be positive")
        if self.irreversible or self.traction != "reference":
            allowed = "a joint that holds along the substrate is reversible, with 'reference' traction"
            raise InputError("adhesion.sliding_length", self.sliding_length, allowed)

    def _check_joint(self, law: JointLaw) -> None:
        if not isinstance(self.against, Boundary):
            allowed = "a joint law holds two bodies together: it needs an interface between two bodies"
            raise InputError("adhesion.law", law.name, allowed)
        if self.irreversible:
            raise InputError("adhesion.irreversible", True, "a joint law states its damage itself")
        if self.scheme != "unbiased":
            allowed = "a joint law has none: its points are paired once"
            raise InputError("adhesion.scheme", self.scheme, allowed)

    @property
    def penetration(self) -> float | None:
        """Largest gap (length) of points in contact by multipliers; None without multipliers."""
        law, share = (self.law.law, 0.5) if isinstance(self.law, Mirrored) else (self.law, 1.0)
        given = law.penetration if isinstance(law, Contact) else None
        return None if given is None else share * given

    @property
    def adheres(self) -> bool:
        """Whether it holds faces together: in contact, and in a crack, they only repel each other."""
        law = self.law.law if isinstance(self.law, Mirrored) else self.law
        return not isinstance(law, Contact) and getattr(law, "initial_damage", 0.0) < 1.0

    @property
    def has_history(self) -> bool:
        """Whether the forces depend on the states before."""
        return (
            self.irreversible
            or self.penetration is not None
            or (isinstance(self.law, JointLaw) and bool(self.law.history))
        )

    @property
    def history_variables(self) -> tuple[HistoryVariable, ...]:
        """What is stored at each point; of a reversible law of the gap zeros."""
        if self.penetration is not None:
            return (REPLACED_OVERLAP,)
        return self.law.history if isinstance(self.law, JointLaw) else (MAXIMUM_OPENING,)

    @property
    def substrate(self) -> Substrate:
        """What it adheres to. Raises InputError if this is another body."""
        if isinstance(self.against, Boundary):
            raise InputError("interface", self.against.body, "this needs an interface with a substrate")
        return self.against

    @property
    def has_potential(self) -> bool:
        """Whether the forces are derivatives of an energy."""
        if isinstance(self.against, Boundary):
            return self.scheme != "two-half-pass"
        return self.traction == "reference"

    @property
    def faces(self) -> tuple["Interface", ...]:
        """The interface as seen from each boundary that is integrated."""
        one_sided = self.scheme == "biased" or isinstance(self.law, JointLaw)
        if not isinstance(self.against, Boundary) or one_sided:
            return (self,)
        return self, replace(self, boundary=self.against, against=self.boundary)

    @property
    def side(self) -> Side:
        """Of its body."""
        return self.boundary.side

    @property
    def start(self) -> float:
        """Parameter along the side at which it begins."""
        return self.boundary.start

    @property
    def end(self) -> float:
        """Parameter along the side at which it ends."""
        return self.boundary.end
