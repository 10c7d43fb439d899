"""Code that all layers use: array types, errors, units, compilation, processes, Ctrl-C, plug-in discovery."""
