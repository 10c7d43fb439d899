"""Evaluation of a run: readings of its curve, fields, the front, closed forms, figures."""
