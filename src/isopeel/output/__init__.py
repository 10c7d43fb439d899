"""What commands make of stored runs, laws and spaces: figures, tables, animations, ParaView files."""
