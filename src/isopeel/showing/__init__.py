"""Stored runs, laws and spaces shown: as figures, tables, animations, in a window, as files for ParaView."""
