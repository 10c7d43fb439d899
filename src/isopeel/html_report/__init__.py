"""A run as one HTML page, which needs no other file: packed data, texts, style and script.

The script is in `script/`, in plain JavaScript; it is part of the page like the data, and nothing is loaded.
"""
