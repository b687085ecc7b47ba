"""Stand-ins for metal: what the tests and benches drive instead of a real machine."""
