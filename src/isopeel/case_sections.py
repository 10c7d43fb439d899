"""The sections of a case file on all but the laws: what each key means."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from isopeel.case_values import A_WINDOW, Angle, Length, Section, window_of


class BodySection(Section):
    """The strip's size, in L0."""

    length: Length
    height: Length


class DiscretizationSection(Section):
    """The spline space, its elements along the length and the height, and the adhesive force's points."""

    space: Annotated[str, Field(description="the name of a space is needed, such as 'N2.1'")] = "N2.1"
    mesh: Annotated[str, Field(description="elements along length x height are needed, such as '200x10'")] = (
        "200x10"
    )
    contact_points: Annotated[
        int | None,
        Field(strict=True, ge=1, description="a number of Gauss points on an element is needed"),
    ] = None


class DriveSection(Section):
    """How far the right face is turned, and in which steps, in degrees."""

    to: Angle = 120.0
    step: Angle = 0.1


class ReadingSection(Section):
    """The window of angles, in degrees, that the plateau is read in."""

    window: Annotated[tuple[float, float], BeforeValidator(window_of), Field(description=A_WINDOW)]


class OutputSection(Section):
    """The angles, in degrees, that the displacement is kept at: multiples of one, and the last."""

    fields_every: Annotated[
        Angle, Field(gt=0, description="a positive angle is needed, such as '10 deg'")
    ] = 10.0
