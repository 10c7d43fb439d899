"""The sections of the report, one file each: the runs that it needs, and its content."""
