"""A run with its files: it is computed, stored, read and resumed."""
