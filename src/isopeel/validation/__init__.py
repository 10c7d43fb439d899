"""Runs held against closed forms: one module per check, and the report on all of them."""
