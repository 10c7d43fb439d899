"""The published benchmark: its tables as data, and our own numbers beside them."""
