"""A file that is run: read, looked through, turned into blocks, begun at a line."""
