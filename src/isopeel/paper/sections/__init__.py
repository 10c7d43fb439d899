"""The sections of the report, one file each: which runs it needs, and what it says."""
