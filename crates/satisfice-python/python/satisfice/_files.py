"""Searches in files."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import stat
import time as clock
from collections.abc import Callable
from pathlib import Path

#: The second checkpoint comes so soon, in seconds, so that a path that cannot be written is noticed.
_FIRST = 1.0
#: Seconds between the others; more where a checkpoint takes more than a tenth of that.
_EVERY = 5.0


def read(path: str | os.PathLike[str] | None) -> bytes | None:
    """The content of a file; None if there is no such file, and for a device or a pipe, which can only be written."""
    if path is None or (os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path)):
        return None
    try:
        if os.path.isdir(path):
            raise _folder()
        return Path(path).read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise _named(error, "read", path) from None


def write(path: str | os.PathLike[str], content: bytes) -> None:
    """Replace a file once all is written. A link is written through; a device or a pipe is written in place."""
    try:
        _write(os.fsdecode(path), content)
    except OSError as error:
        # The file that it names may be a temporary one, which means nothing to the user.
        raise _named(error, "write", path) from None


def _folder() -> OSError:
    return IsADirectoryError(errno.EISDIR, "it is a folder: name a file in it")


def _named(error: OSError, verb: str, path: str | os.PathLike[str]) -> OSError:
    return type(error)(error.errno, f"cannot {verb} the search: {error.strerror}", os.fspath(path))


def _write(path: str, content: bytes) -> None:
    target = os.path.realpath(path)
    try:
        found = os.stat(target)
    except FileNotFoundError:
        _beside(target, content, mode=None)
        return
    if stat.S_ISDIR(found.st_mode):
        raise _folder()
    if not stat.S_ISREG(found.st_mode):
        with open(target, "wb") as file:
            file.write(content)
        return
    if not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, "the file may not be written to")
    _beside(target, content, stat.S_IMODE(found.st_mode))


def _beside(target: str, content: bytes, mode: int | None) -> None:
    """Write a file beside its place, and move it there when it is whole."""
    folder, name = os.path.split(target)
    # Not `tempfile`, whose files only their owner may read. A long name is cut: with an ending it would be too long.
    partial = os.path.join(folder, f".{name[:40]}.{secrets.token_hex(4)}.partial")
    file = open(partial, "xb")
    try:
        with file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if mode is not None:
            os.chmod(partial, mode)
        os.replace(partial, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.remove(partial)
        raise


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
