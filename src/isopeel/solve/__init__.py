"""Equilibria along a path: Newton's method, chord tangents, predictors, path control."""
