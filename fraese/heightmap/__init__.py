"""Height maps: how warped the work lies, kept in a file, and moves bent to it."""
