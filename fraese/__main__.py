"""``python -m fraese`` and the ``fraese`` command (SMCMAIN)."""

from fraese.cli import main

if __name__ == "__main__":
    main()
