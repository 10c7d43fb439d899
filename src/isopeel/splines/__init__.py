"""Splines: knot vectors, bases, NURBS and the row-wise space. Knows nothing of mechanics."""
