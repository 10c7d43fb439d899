"""The strip peeled by a pure moment, in scikit-fem and PARDISO: what isopeel's speed is measured against.

One program, but for the assembly: by scikit-fem's forms, or by hand-tuned matrix products.
"""

from scikit_fem_strip.blas import BlasAssembly
from scikit_fem_strip.forms import FormsAssembly
from scikit_fem_strip.strip import Strip
from scikit_fem_strip.trace import ENERGY_TOLERANCE, Assembly, LoadStep, trace

__all__ = ["ENERGY_TOLERANCE", "Assembly", "BlasAssembly", "FormsAssembly", "LoadStep", "Strip", "trace"]
