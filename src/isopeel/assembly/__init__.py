"""From a problem and a spline space to forces and tangents: tables, kernels, constraints, the system."""
