"""The curve, the file of a run and its journal, provenance; files are read as untrusted."""
