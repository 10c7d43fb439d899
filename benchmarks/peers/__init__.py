"""The strip peeled by a pure moment in isopeel and in other libraries, each in a separate program.

`python -m peers NAME DEGREE ALONG ACROSS` runs one of them; `peers.protocol` defines its input and output.
"""
