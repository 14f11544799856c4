"""``python -m vedette``: the command."""

from vedette.cli import main

if __name__ == "__main__":
    main()
