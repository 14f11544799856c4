"""``python -m vedette``, and ``vedette``: the command."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command; Ctrl-C while it is being imported, which takes a moment, ends it without a word."""
    try:
        # Not until Ctrl-C can be caught.
        from vedette.cli import main as run

        run()
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
