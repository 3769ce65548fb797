"""Processes of our own: one that dies is replaced, and all end with the process that searches."""

from __future__ import annotations

import concurrent.futures as futures
import multiprocessing
import multiprocessing.connection
import os
import signal
import threading
from collections.abc import Callable
from typing import Any

from ._workers import outcome

#: How often a worker looks whether the process that searches is there, in seconds, where it is not told.
_LOOK_EVERY = 1.0


class Own:
    """Processes of our own, which are replaced when one dies."""

    def __init__(self, workers: int) -> None:
        if workers < 1:
            raise ValueError(f"workers = {workers} is not allowed: at least 1")
        self.workers, self.generation = workers, 0
        self.pool = self._start()

    def _start(self) -> futures.ProcessPoolExecutor:
        return futures.ProcessPoolExecutor(self.workers, initializer=_begin)

    def __enter__(self) -> Own:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def _end(self) -> None:
        processes = list((getattr(self.pool, "_processes", None) or {}).values())
        self.pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.terminate()

    def submit(self, f: Callable[..., Any], /, *args: Any) -> Any:
        return self.pool.submit(f, *args)

    def outcomes(self, done: list[Any]) -> list[Any]:
        """What came of calls that are done: a result or an exception each."""
        return [outcome(future) for future in done]

    def replace(self, error: BaseException) -> None:
        self._end()
        self.pool = self._start()
        self.generation += 1


def _begin() -> None:
    """Begin a worker. Ctrl-C is for the process that searches; when that is gone, nobody would end the worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    # Later workers that were forked hold the sentinels of earlier ones open, but every one of them has a new parent.
    parent = os.getppid()
    while not multiprocessing.connection.wait([sentinel], _LOOK_EVERY) and os.getppid() == parent:
        pass
    os._exit(1)
