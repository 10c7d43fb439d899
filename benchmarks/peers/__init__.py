"""The strip peeled by a pure moment in isopeel and in other libraries, each a program of its own.

`python -m peers NAME DEGREE ALONG ACROSS` runs one of them; `peers.protocol` says what it understands.
"""
