"""What a run leaves behind: the curve, fields and provenance, in files that other programs read."""
