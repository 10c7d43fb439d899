"""Materials, adhesion laws and substrates: small frozen objects with formulas; no meshes, no solvers.

Each object has its numbers (`parameters`) and a compiled batch function (`kernel`) that evaluates its
formulas at many points at once. The assembly calls that function through its address, so that a new law
compiles alone, runs at full speed, and leaves every other compiled function as it is.
"""
