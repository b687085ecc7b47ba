"""The rows of the key table that depend on no machine, by the room they belong to."""
