"""Tables of functions, compiled loops, constraints, the assembled system; no load steps."""
