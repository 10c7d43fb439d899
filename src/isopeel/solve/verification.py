"""Verification of a step: its energy must come from the work of the drive."""

from isopeel.solve.balance import NO_MISFIT, Misfit
from isopeel.solve.branch import Branch
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.path import Path
from isopeel.solve.step import Found


def without_gain(path: Path, found: Found) -> Found:
    """Return an equilibrium that has gained no energy without work; raises ConvergenceError otherwise.

    A step to another branch of less energy is accepted, as in published studies; one of more energy is not.
    """
    misfit = path.misfit(found.result)
    if misfit is NO_MISFIT:
        return found
    if not misfit.gains:
        return found._replace(is_balanced=misfit.fits)
    misfit, _ = Branch(path).verified(found, misfit, by_order=True)
    if misfit.gains:
        raise _unbalanced(path, found, misfit)
    return found._replace(is_balanced=True)


def balanced(path: Path, branch: Branch, found: Found, *, cuts: bool) -> Found:
    """Return an equilibrium whose energy comes from the work of the drive; raises ConvergenceError otherwise.

    Where the ends of the step do not suffice to decide: if the step may be cut (`cuts`), the error makes the
    path cut it; if not, the branch inside the step is followed, and its first state is returned. A step whose
    misfit may be the error of the trapezoidal rule stays whole.
    """
    misfit = path.misfit(found.result)
    if misfit is NO_MISFIT:
        return found
    inside: list[Found] = []
    if not misfit.fits and (misfit.is_slight or not cuts):
        misfit, inside = branch.verified(found, misfit, by_order=not cuts)
    if not misfit.fits:
        raise _unbalanced(path, found, misfit)
    return inside[0] if len(inside) > 1 and not misfit.is_slight else found._replace(is_balanced=True)


def _unbalanced(path: Path, found: Found, misfit: Misfit) -> ConvergenceError:
    path.solver.drop_tangent()
    energy = f"{abs(misfit.gained):.3g} E0 L0^3"
    if misfit.gains:
        reason = f"the energy grows by {energy} without work of the drive: it is another branch"
    elif misfit.gained < 0:
        reason = f"the step releases an energy of {energy}: it passes a jump, or is too long"
    else:
        reason = "the step has met another branch"
    return ConvergenceError(reason, found.result.iterations, found.parameter, "energy without work")
