"""A console that shows texts, which may come from anywhere, and obeys nothing in them."""

from collections.abc import Iterable
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

from isopeel.common.errors import visible


class PlainConsole(Console):
    """A console on which control characters of a text are visible; colours and bars are its own."""

    def render_str(self, text: str, **options: Any) -> Text:
        """Make a text of a string, as wide as it is when all of it is visible."""
        return super().render_str(visible(text), **options)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Render what was not a string, too."""
        for segment in super().render(renderable, options):
            text, style, control = segment
            yield segment if control else Segment(visible(text), style)
