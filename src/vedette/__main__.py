"""``python -m vedette``: the command."""

from vedette.cli import main

main()
