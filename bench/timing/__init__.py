"""How late the steps are: measured, beside others, drawn. See ``python -m bench.timing --help``."""
