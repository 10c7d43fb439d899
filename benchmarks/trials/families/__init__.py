"""Families of cases with a known answer; one file each."""
