"""A run as one HTML page, which needs no other file: packed data, texts, style and script.

The script is in `script/`, in plain JavaScript. Script and data are inside the page, which loads nothing.
"""
