"""Searches in files."""

from __future__ import annotations

import os
import time as clock
from collections.abc import Callable
from pathlib import Path

#: The second checkpoint comes so soon, in seconds, so that a path that cannot be written is noticed.
_FIRST = 1.0
#: Seconds between the others; more where a checkpoint takes more than a tenth of that.
_EVERY = 5.0


def read(path: str | os.PathLike[str] | None) -> bytes | None:
    """The content of a file; None if there is no such file."""
    if path is None:
        return None
    try:
        return Path(path).read_bytes()
    except FileNotFoundError:
        return None


def write(path: str | os.PathLike[str], content: bytes) -> None:
    """Replace a file once all is written."""
    partial = f"{os.fspath(path)}.{os.getpid()}.partial"
    with open(partial, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(partial, path)


class Keeper:
    """Writes a search to a file now and then; to none without a path."""

    def __init__(self, path: str | os.PathLike[str] | None, state: Callable[[], bytes]) -> None:
        self._path, self._state = path, state
        self._next, self._every = clock.monotonic(), _FIRST

    def save_if_due(self) -> None:
        if self._path is not None and clock.monotonic() >= self._next:
            self.save()

    def save(self) -> None:
        if self._path is None:
            return
        begun = clock.monotonic()
        write(self._path, self._state())
        end = clock.monotonic()
        self._next = end + max(self._every, 9 * (end - begun))
        self._every = _EVERY
