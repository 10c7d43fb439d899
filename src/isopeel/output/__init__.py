"""Output of stored runs, laws and spaces: figures, tables, animations, a window, ParaView files."""
