"""A console that shows untrusted texts: control characters in them have no effect."""

from collections.abc import Iterable
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

from isopeel.common.errors import visible


class PlainConsole(Console):
    """A console that makes control characters of texts visible; its own colours and bars still work."""

    def render_str(self, text: str, **options: Any) -> Text:
        """Return a string as a text whose width is that with visible control characters."""
        return super().render_str(visible(text), **options)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Render objects that are not strings, with visible control characters too."""
        for segment in super().render(renderable, options):
            text, style, control = segment
            yield segment if control else Segment(visible(text), style)
