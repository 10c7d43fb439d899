"""Identification: parameters of a case from measured curves, by nonlinear least squares.

Start at `identification.fit_file` (what a fit is), `identification.model` (the curves of a case as a function
of its parameters), `identification.least_squares`, `identification.statistics` and `identification.run`.
"""
