"""The layers of the package. Data flows one way: a layer imports only from those to its left.

A layer is a folder of the package. `tests/package/test_layers.py` reads all imports and proves the flow.
"""

from collections.abc import Mapping
from types import MappingProxyType

#: For each layer the layers directly to its left, in the order of the flow. Layers further to the left may be
#: imported too, see `left_of`.
LAYERS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "common": (),
        "splines": ("common",),
        "physics": ("common",),
        "matrix": ("common",),
        "problem": ("splines", "physics"),
        "assembly": ("problem", "matrix"),
        "solve": ("assembly",),
        "results": ("solve",),
        "post": ("results",),
        "case": ("problem",),
        "running": ("case", "post"),
        "report": ("running",),
        "html_report": ("running",),
        "output": ("running",),
        "paper": ("report",),
        "validation": ("report",),
        "study": ("report",),
        "identification": ("study",),
        "cli": ("paper", "validation", "identification", "html_report", "output"),
    }
)


def left_of(layer: str) -> frozenset[str]:
    """Return the layers that a layer may import; raises KeyError if there is no such layer."""
    return frozenset(LAYERS[layer]).union(*map(left_of, LAYERS[layer]))
