"""The strip peeled by a pure moment, in scikit-fem and PARDISO: what isopeel's speed is measured against.

One program, but for assembly and solver: as the examples show, as an expert writes it, or tuned by hand.
"""

from scikit_fem_strip.peers import PEERS
from scikit_fem_strip.strip import Strip
from scikit_fem_strip.trace import ENERGY_TOLERANCE, LoadStep, trace

__all__ = ["ENERGY_TOLERANCE", "PEERS", "LoadStep", "Strip", "trace"]
