"""A run as one HTML page that opens anywhere: its data, packed, the texts, style and script.

The script is in `script/`, in plain JavaScript, and is put into the page with the data; nothing is loaded.
"""
