"""A run as one page that opens anywhere: its data, packed, and the HTML, style and script around them.

The script is in `script/`, in plain JavaScript, and is put into the page with the data; nothing is loaded.
"""
