"""Where runs can be carried out, and what has to be installed for it."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Literal

from vedette.errors import InputError

Backend = Literal["loky", "dask"]
BACKENDS: tuple[Backend, ...] = ("loky", "dask")


def require(backend: Backend) -> None:
    """Check that all that a study needs is installed.

    Raises:
        InputError: it is not.
    """
    missing = [package for package in ("joblib", "pyarrow") if find_spec(package) is None]
    if missing:
        raise InputError(f"a study needs {' and '.join(missing)}; install with: pip install 'vedette[study]'")
    if backend == "dask" and find_spec("distributed") is None:
        raise InputError("--backend dask needs Dask; install it with: pip install 'dask[distributed]'")
