"""``python -m waybound`` is the command ``waybound``."""

from .cli import main

if __name__ == "__main__":
    main()
