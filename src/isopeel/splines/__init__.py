"""Knot vectors, bases, NURBS and the row-wise space; no mechanics."""
