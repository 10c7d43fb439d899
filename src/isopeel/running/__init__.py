"""A run with its files: it is followed, stored, read back and resumed."""
