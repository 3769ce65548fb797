"""Searches in files."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import stat
import time as clock
import warnings
from collections.abc import Callable
from pathlib import Path

#: The second checkpoint comes so soon, in seconds, so that a path that cannot be written is noticed.
_FIRST = 1.0
#: Seconds between the others.
_EVERY = 5.0
#: Between two checkpoints is at least so many times the time that the first of them took.
_TIMES = 9


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


class Writer:
    """Writes a search to its file again and again. A write that fails after one that did not is a warning, and the search goes on."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._path = path
        self._has_written, self._has_warned = False, False
        #: Why the last write failed.
        self._unwritten: OSError | None = None

    def __call__(self, content: bytes) -> None:
        try:
            write(self._path, content)
        except OSError as error:
            if not self._has_written:
                raise
            self._unwritten = error
            if not self._has_warned:
                self._has_warned = True
                _warn(f"{error}; the search goes on, and later writes are tried again")
        else:
            self._has_written, self._unwritten = True, None

    def end(self) -> None:
        """Tell that the file does not hold the end of the search, if so."""
        if self._unwritten is not None:
            _warn(f"the file of the search does not hold its end: {self._unwritten}")


def _warn(text: str) -> None:
    warnings.warn(text, RuntimeWarning, stacklevel=3)


class Keeper:
    """Writes a search to a file now and then; to none without a path."""

    def __init__(self, path: str | os.PathLike[str] | None, state: Callable[[], bytes]) -> None:
        self._writer, self._state = None if path is None else Writer(path), state
        self._next, self._every = clock.monotonic(), _FIRST

    def save_if_due(self) -> None:
        if self._writer is not None and clock.monotonic() >= self._next:
            self._save(self._writer)

    def end(self) -> None:
        """Write the end of the search."""
        if self._writer is not None:
            self._save(self._writer)
            self._writer.end()

    def end_with(self, error: BaseException) -> None:
        """Write the end of a search that an exception ends, which is more than that the file cannot be written."""
        try:
            self.end()
        except OSError as unwritten:
            if not isinstance(error, OSError) or str(error) != str(unwritten):
                _warn(str(unwritten))

    def _save(self, writer: Writer) -> None:
        begun = clock.monotonic()
        writer(self._state())
        end = clock.monotonic()
        self._next = end + max(self._every, _TIMES * (end - begun))
        self._every = _EVERY
