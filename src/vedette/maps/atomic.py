"""Put a file in place whole or not at all."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from vedette.errors import InputError


@contextlib.contextmanager
def atomic_path(path: Path | str, mark: str = ".part-") -> Iterator[Path]:
    """Yield a temporary path in the same folder; move it onto ``path`` when the block succeeds.

    The temporary name, ``mark`` before that of ``path``, keeps the suffix, from which many writers infer the
    format. Where the block fails, ``path`` keeps what it held and the temporary file is removed.

    Raises:
        InputError: the file cannot be written there.
    """
    path = Path(path)
    temporary = path.with_name(f"{mark}{path.name}")
    try:
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror or error}; choose another folder") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
