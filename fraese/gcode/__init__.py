"""Program text to canonical moves, in millimetres."""
