"""Runs compared with closed forms: one module per check, and the report on all of them."""
