"""Equilibria along a path: linear solvers, Newton's method, predictors, the trace."""
