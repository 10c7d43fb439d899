"""What all layers share: array types, errors, units, compilation, processes, Ctrl-C, component discovery."""
