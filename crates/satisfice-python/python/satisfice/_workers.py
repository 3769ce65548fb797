"""Where functions are evaluated: calls that are sent there, and the executors of the user."""

from __future__ import annotations

import concurrent.futures as futures
import os
import pickle
import time as clock
import traceback
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

#: How often a search that waits for values looks for its time and for Ctrl-C, in seconds.
LOOK_EVERY = 0.05
#: What was lost with its worker so often is given up.
MOST_LOSSES = 3


class ExecutorLike(Protocol):
    """What `Search.run` needs of an executor: `concurrent.futures.Executor`, Dask's, mpi4py's and others have it."""

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Any:
        """Start a call; the future returned has ``result`` and ``add_done_callback``."""


#: A value of the user's function, with its components where it tells some.
Value = float | tuple[float, NDArray[np.float64]]


class Guarded:
    """The user's function where it is called: a caught exception becomes None, a value with components a tuple of both."""

    def __init__(self, f: Callable[[Any], Any], catch: tuple[type[BaseException], ...], components: int = 0) -> None:
        self.f, self.catch, self.components = f, catch, components

    def __call__(self, x: NDArray[np.float64]) -> Value | None:
        try:
            value = self.f(x)
        except self.catch:
            return None
        except StopIteration as error:
            # It would end the iteration of whoever calls this.
            raise RuntimeError(f"f raised StopIteration at x = {x}") from error
        if self.components == 0:
            return _number(value, x)
        value, components = pair(value, self.components)
        number, components = _number(value, x), np.asarray(components)
        if components.shape != (self.components,):
            raise ValueError(
                f"f returned components of shape {components.shape} at x = {x}: "
                f"with components={self.components} they must have shape ({self.components},)"
            )
        if components.dtype.kind not in "biuf":
            raise TypeError(f"f returned components of {components.dtype} at x = {x}: they must be real numbers")
        return number, components.astype(np.float64)

    def all(self, points: list[NDArray[np.float64]]) -> tuple[list[Value | None], float]:
        """The values at some points, one after the other, and the seconds that they took."""
        begun = clock.monotonic()
        values = [self(x) for x in points]
        return values, clock.monotonic() - begun


class Sent:
    """A function that an executor calls, maybe in another process: an exception that could not come back from there is told as text."""

    def __init__(self, f: Callable[..., Any]) -> None:
        self.f, self.is_elsewhere = f, False
        #: By which Dask calls its tasks.
        self.__name__ = getattr(f, "__name__", "f")

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "is_elsewhere": True}

    def __call__(self, *args: Any) -> Any:
        try:
            return self.f(*args)
        except BaseException as error:
            if not self.is_elsewhere or _comes_back(error):
                raise
            text = "".join(traceback.format_exception(error))
            kind = type(error).__qualname__
            told = RuntimeError(f"f raised {kind}, an exception that cannot be sent from process to process (pickled):\n{text}")
        raise told


def _comes_back(error: BaseException) -> bool:
    try:
        return isinstance(pickle.loads(pickle.dumps(error)), type(error))
    except Exception:
        return False


def pair(value: Any, components: int) -> tuple[Any, Any]:
    """What a function with components returned."""
    if not isinstance(value, tuple) or len(value) != 2:
        kind = type(value).__name__
        raise TypeError(
            f"f returned {value!r} of type {kind}: with components={components} it must return a tuple (value, components)"
        )
    return value


def _number(value: Any, x: NDArray[np.float64]) -> float:
    # `float` takes text, and the real part of complex numbers of numpy.
    if not (isinstance(value, (str, bytes, bytearray)) or np.iscomplexobj(value)):
        try:
            return float(value)
        except (TypeError, ValueError):
            pass
    kind = type(value).__name__
    raise TypeError(f"f returned {value!r} of type {kind} at x = {x}: it must return one real number")


def check_pickle(f: Callable[[Any], Any]) -> None:
    try:
        pickle.dumps(f)
    except Exception as error:
        raise TypeError(
            f"{f!r} cannot be sent to another process: define it at the top level of a module, or pass an executor that "
            "sends functions by value, such as Dask's"
        ) from error


def is_killed(error: BaseException) -> bool:
    """Whether Dask gave a task up because it was lost with several workers."""
    return type(error).__name__ == "KilledWorker"


def shaped(executor: Any) -> tuple[Given, int | None]:
    """An executor of the user, or a Dask client, and how many workers it has, where that is known."""
    if hasattr(executor, "get_executor"):
        threads = executor.nthreads()
        return Dask(executor), sum(threads.values()) or None
    if not hasattr(executor, "submit"):
        raise TypeError(f"{executor!r} is no executor: it has no method submit")
    return Given(executor), known_workers(executor)


def known_workers(pool: Any) -> int | None:
    """How many workers an executor or a pool says it has: those of `concurrent.futures` and loky, `multiprocessing`, mpi4py, Dask."""
    client = getattr(pool, "_client", None)
    if client is not None and hasattr(client, "nthreads"):
        return sum(client.nthreads().values()) or None
    for name in ("_max_workers", "_processes", "num_workers"):
        workers = getattr(pool, name, None)
        if isinstance(workers, int) and workers > 0:
            return workers
    return None


def assumed_workers(pool: Any) -> int:
    """As many workers as a pool, or the pool of a bound ``pool.map``, says it has; as many as this machine has CPUs where it says nothing."""
    if pool is map:
        return 1
    return known_workers(getattr(pool, "__self__", pool)) or os.cpu_count() or 1


class Given:
    """An executor of the user. When it breaks, the search ends; it can go on with another one."""

    generation = 0
    #: Whether it costs milliseconds to send a task.
    is_far = False

    def __init__(self, executor: ExecutorLike) -> None:
        self.submit = executor.submit

    def outcomes(self, done: list[Any]) -> list[Any]:
        """What came of calls that are done: a result or an exception each."""
        return [outcome(future) for future in done]

    def replace(self, error: BaseException) -> None:
        raise error


class Dask(Given):
    """The workers of a Dask client. Results are fetched together: its executor asks for each by itself."""

    is_far = True

    def __init__(self, client: Any) -> None:
        self.client = client

    def submit(self, f: Callable[..., Any], /, *args: Any) -> Any:
        return self.client.submit(f, *args, pure=False)

    def outcomes(self, done: list[Any]) -> list[Any]:
        whole = [future for future in done if future.status == "finished"]
        found = dict(zip(whole, self.client.gather(whole, errors="skip"), strict=False)) if whole else {}
        if len(found) < len(whole):
            found = {}  # some were lost with their worker: which ones is seen one by one
        return [found[future] if future in found else outcome(future) for future in done]


def outcome(future: Any) -> Any:
    try:
        return future.result()
    except Exception as error:
        return error
