"""`find`: a search in one call."""

from __future__ import annotations

import functools
import json
import math
import os
import secrets
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from . import _files, _satisfice
from ._names import texts

_MOST = 2.0**53


class Progress(NamedTuple):
    """What a callback is told.

    Attributes
    ----------
    evaluations, hits : int
        Evaluations and distinct hits so far.
    time : float
        Seconds since the start.
    share : float
        The share of the budget that is used, from 0 to 1.
    """

    evaluations: int
    hits: int
    time: float
    share: float


def find(
    f: Callable[[Any], Any] | _satisfice.Problem,
    bounds: Any = None,
    *,
    delta: float | None = None,
    separation: float | Sequence[float] | None = None,
    time: float | None = None,
    evaluations: int | None = None,
    hits: int | None = None,
    slices: int = 1,
    engine: str = "portfolio",
    options: Mapping[str, Any] | None = None,
    seed: int | None = None,
    probes: float | None = None,
    islands: int = 1,
    threads: int = 1,
    integrality: Any = None,
    categories: Mapping[int, Sequence[Any]] | None = None,
    x0: Any = None,
    vectorized: bool = False,
    workers: Any = 1,
    executor: Any = None,
    ordered: bool = False,
    callback: Callable[[Progress], Any] | None = None,
    catch: type[BaseException] | tuple[type[BaseException], ...] = (),
    checkpoint: str | os.PathLike[str] | None = None,
    reference: bool = False,
) -> _satisfice.Report:
    """Find as many distinct x with f(x) < delta as possible.

    Parameters
    ----------
    f : callable or Problem
        The function, ``f(x) -> float`` with `x` of shape (d,), or with `vectorized` ``f(X) -> values`` with `X` of shape
        (n, d) and values of shape (n,). It is called on the calling thread, with a fresh float64 array that it may change.
        A value that is NaN or infinite is never a hit, and is counted. Or a problem of the catalogue (see `problem`),
        for which `bounds`, `delta`, `separation`, `integrality`, `categories`, `x0`, `vectorized`, `workers`, `executor` and
        `catch` do not apply.
    bounds : sequence of (lower, upper), or scipy.optimize.Bounds
        The range of each axis, both ends included. ``None`` for an axis in `categories`.
    delta : float
        A hit is a point with f(x) < delta, strictly.
    separation : float or sequence of float, optional
        Hits within this Euclidean distance count as one, in units of the axes; with one number per axis, hits within the
        ellipsoid that has these half-axes (0 on an integer axis: different integers are different hits). Without it,
        different coordinates are different hits: on continuous axes nearly every hit then is a new one.
    time : float, optional
        Wall time in seconds. `time` or `evaluations` is required.
    evaluations : int, optional
        Evaluations. Candidates that are known already count, so that the search ends. With it and without `time`, the
        same seed gives the same report, apart from times, on every machine.
    hits : int, optional
        Also end at this number of distinct hits.
    slices : int, default 1
        For a problem of the catalogue: the number of time slices, each with the budget above and warm from the one before.
    engine : str, default "portfolio"
        Name of the engine, see `engines`.
    options : mapping, optional
        Options of the engine by name; ``_`` stands for ``-`` in a name.
    seed : int, optional
        From 0 to 2**64 - 1. If missing, one is drawn; the report tells it.
    probes : float, optional
        The share of the evaluations, from 0 to 0.5, spent on uniform points, from which the report estimates the number of
        hits not seen. By default as the engine prefers.
    islands : int, default 1
        The number of engines side by side that share their hits: after 256 evaluations of each, then 512, then every 1,024.
    threads : int, default 1
        For a problem of the catalogue: the threads that evaluate, 0 for one per core. It does not change the report.
    integrality : bool or sequence of bool, optional
        Which axes are integers (as in `scipy.optimize.differential_evolution`).
    categories : mapping of int to sequence, optional
        Labels of axes that are categories: ``{2: ["steel", "brass"]}``. `f` gets the index of the label.
    x0 : array-like of shape (d,) or (m, d), optional
        Points to evaluate first, inside the bounds: good guesses, or hits of another run. Engines start from the best ones.
    vectorized : bool, default False
        Whether `f` takes all points of a batch at once.
    workers : int, map-like, or Executor, default 1
        Where `f` is evaluated: so many processes, a function such as ``pool.map``, or a `concurrent.futures.Executor` (Dask's,
        mpi4py's, ...). See `Search.run`. A `callback` is not called then.
    executor : int, Executor or Dask client, optional
        Where the islands run: an island and `f` with it, a round of it a task. For an `f` that is cheap beside what it costs
        to send a point away. A number starts so many processes. A round that is lost with its worker is run again elsewhere;
        under a budget of evaluations the report is that of the same islands on this process. Exceptions keep what was found
        until the last exchange of the islands. With one island, the same as `workers`.
    ordered : bool, default False
        With several workers: whether the report does not depend on the order of their values. See `Search`.
    callback : callable, optional
        Called with a `Progress` at most about a hundred times a second; the search ends when it returns true.
    catch : exception type or tuple of them, default ()
        Exceptions of `f` that count as a value of NaN. They are counted in ``report.failed``; with `vectorized` an
        exception fails its whole batch.
    checkpoint : path, optional
        Keep the search in this file: at the beginning, after a second, then every five, and at the end, however it comes. If
        the file is there, the search goes on from it, and all other arguments must be the same (`seed` may be left out).
        Under a budget of evaluations the report is then that of one uninterrupted search, except with `workers`
        that are not `ordered`.
    reference : bool, default False
        For a problem of the catalogue: also count all its hits, for the recall. It can take long.

    Returns
    -------
    Report
        The hits and everything needed to repeat the search.

    Raises
    ------
    ValueError
        For arguments that are not usable; the message says what is.
    TypeError
        For a value of `f` that is no real number.
    KeyboardInterrupt, or an exception of `f` or `callback`
        Ends the search. What was found until then is its attribute ``report``.

    Examples
    --------
    >>> import numpy as np
    >>> import satisfice
    >>> def himmelblau(x):
    ...     return (x[0] ** 2 + x[1] - 11) ** 2 + (x[0] + x[1] ** 2 - 7) ** 2
    >>> report = satisfice.find(himmelblau, [(-5, 5)] * 2, delta=1e-3, separation=0.1, evaluations=20_000, seed=1)
    >>> report.hits
    4
    >>> sorted(np.round(report.x[:, 0]).astype(int).tolist())
    [-4, -3, 3, 4]
    """
    if callback is not None and not callable(callback):
        raise TypeError("callback must be callable")
    told = None if callback is None else _told(callback)
    saved = _files.read(checkpoint)
    if seed is None and saved is not None:
        seed = _satisfice.saved_seed(saved)
    if executor is not None:
        if not _is_one(workers):
            raise ValueError("workers evaluate, and an executor runs islands: give one of them")
        if islands == 1:
            workers, executor = executor, None
    run = run_arguments(engine, options, seed, time, evaluations, hits, slices, probes, islands, threads)
    if isinstance(f, _satisfice.Problem):
        given = {
            "bounds": bounds is not None,
            "delta": delta is not None,
            "separation": separation is not None,
            "integrality": integrality is not None,
            "categories": categories is not None,
            "x0": x0 is not None,
            "vectorized": vectorized,
            "catch": catch != (),
            "workers": not _is_one(workers),
            "executor": executor is not None,
        }
        for name, is_given in given.items():
            if is_given:
                raise ValueError(f"{name} does not apply: a problem of the catalogue has its own")
        return f._run(run, told, reference, saved, _writer(checkpoint))
    if not callable(f):
        raise TypeError(f"f must be callable or a satisfice.Problem, not {type(f).__name__}")
    for name, value, default in [("threads", threads, 1), ("slices", slices, 1), ("reference", reference, False)]:
        if value != default:
            raise ValueError(f"{name} applies to problems of the catalogue only; a function is called on the calling thread")
    catch = catch if isinstance(catch, tuple) else (catch,)
    asked = question(_name(f), bounds, delta, separation, integrality, categories, x0)
    if executor is not None:
        from ._islands import find_with_islands

        return find_with_islands(
            f,
            asked,
            run,
            executor,
            vectorized=bool(vectorized),
            told=told,
            catch=catch,
            checkpoint=checkpoint,
            saved=saved,
        )
    if not _is_one(workers):
        if vectorized or callback is not None:
            raise ValueError("vectorized and callback apply to calls on this thread: leave workers out, or them")
        from ._search import Search

        search = Search._begin(asked, run, ordered)
        if saved is not None:
            search._set(search._search.load_same(saved))
        on = {"executor": workers} if hasattr(workers, "submit") else {"workers": workers}
        return search.run(f, **on, catch=catch, checkpoint=checkpoint)
    return _satisfice.find(f, asked, run, bool(vectorized), told, catch, saved, _writer(checkpoint))


def _writer(path: str | os.PathLike[str] | None) -> Callable[[bytes], None] | None:
    return None if path is None else functools.partial(_files.write, path)


def _told(callback: Callable[[Progress], Any]) -> Callable[[int, int, float, float], bool]:
    return lambda evaluations, hits, time, share: bool(callback(Progress(evaluations, hits, time, share)))


def _is_one(workers: Any) -> bool:
    return isinstance(workers, int) and workers == 1


def run_arguments(
    engine: str,
    options: Mapping[str, Any] | None,
    seed: int | None,
    time: float | None,
    evaluations: int | None,
    hits: int | None,
    slices: int,
    probes: float | None,
    islands: int,
    threads: int,
) -> dict[str, Any]:
    """Engine, seed and budget, as the native part takes them."""
    if time is None and evaluations is None:
        raise ValueError("nothing limits the search: give time= in seconds or evaluations=")
    return {
        "engine": engine,
        "options": texts(options or {}),
        "seed": secrets.randbits(32) if seed is None else _whole("seed", seed, least=0),
        "time": None if time is None else _real("time", time),
        "evaluations": None if evaluations is None else _whole("evaluations", evaluations),
        "hits": None if hits is None else _whole("hits", hits),
        "slices": _whole("slices", slices),
        "probes": None if probes is None else _real("probes", probes),
        "islands": _whole("islands", islands),
        "threads": _whole("threads", threads, least=0),
    }


def question(
    name: str,
    bounds: Any,
    delta: float | None,
    separation: float | Sequence[float] | None,
    integrality: Any,
    categories: Mapping[int, Sequence[Any]] | None,
    x0: Any,
) -> dict[str, Any]:
    """What is searched, as the native part takes it."""
    if bounds is None:
        raise ValueError("bounds is missing: give (lower, upper) for each axis")
    if delta is None:
        raise ValueError("delta is missing: a hit is a point with f(x) < delta")
    if math.isnan(delta):
        raise ValueError("delta is NaN: no value is below it")
    axes, labels = _axes(bounds, integrality, dict(categories or {}))
    if separation is None:
        widths = None
    elif _is_number(separation):
        # A radius says nothing about categories: different ones are different hits.
        radius = _real("separation", separation)
        if not radius > 0:
            raise ValueError(f"separation = {radius} is not allowed: a positive number, or none for exact coordinates")
        widths = [0.0 if axis in labels else radius for axis in range(len(axes))]
    else:
        widths = [float(width) for width in _list(separation)]
    parameters: dict[str, Any] = {"function": name, "bounds": [list(axis[:2]) for axis in axes]}
    if any(axis[2] for axis in axes):
        parameters["integrality"] = [axis[2] for axis in axes]
    if labels:
        parameters["categories"] = {str(axis): [str(label) for label in words] for axis, words in labels.items()}
    if widths is not None:
        parameters["separation"] = widths
    starts = _starts(x0, len(axes))
    if starts:
        parameters["x0"] = starts
    return {
        "axes": axes,
        "delta": float(delta),
        "separation": widths,
        "starts": starts,
        "name": "function",
        "parameters": json.dumps(parameters),
    }


def _starts(x0: Any, dimension: int) -> list[list[float]]:
    if x0 is None:
        return []
    points = np.asarray(x0, dtype=np.float64)
    shape = points.shape
    points = points.reshape(1, -1) if points.ndim == 1 else points
    if points.ndim != 2 or points.shape[1] != dimension:
        raise ValueError(f"x0 has shape {shape}: give ({dimension},) for one point, or (m, {dimension})")
    starts: list[list[float]] = points.tolist()
    for index, start in enumerate(starts):
        if not all(map(math.isfinite, start)):
            raise ValueError(f"start point {index} is not finite: {start}")
    return starts


def _axes(
    bounds: Any, integrality: Any, categories: dict[int, Sequence[Any]]
) -> tuple[list[tuple[float, float, bool]], dict[int, list[Any]]]:
    if hasattr(bounds, "lb") and hasattr(bounds, "ub"):  # scipy.optimize.Bounds
        lower, upper = _list(bounds.lb), _list(bounds.ub)
        count = max(len(lower), len(upper))
        if not {len(lower), len(upper)} <= {1, count}:
            raise ValueError(f"bounds has {len(lower)} lower and {len(upper)} upper ends: give as many of both")
        lower, upper = (ends * count if len(ends) == 1 else ends for ends in (lower, upper))
        pairs: list[Any] = list(zip(lower, upper, strict=True))
    else:
        pairs = list(bounds)
    if integrality is None:
        whole = [False] * len(pairs)
    else:
        whole = [bool(value) for value in _list(integrality)]
        whole = whole * len(pairs) if _is_number(integrality) else whole
        if len(whole) != len(pairs):
            raise ValueError(f"integrality has {len(whole)} entries for {len(pairs)} axes")
    labels = {}
    for axis, words in categories.items():
        if not 0 <= axis < len(pairs):
            raise ValueError(f"categories names axis {axis}, but the axes are 0 to {len(pairs) - 1}")
        labels[axis] = list(words)
        if not labels[axis]:
            raise ValueError(f"axis {axis} has no category: give at least one label")
        pairs[axis], whole[axis] = (0, len(labels[axis]) - 1), True
    axes = []
    for axis, (pair, is_whole) in enumerate(zip(pairs, whole, strict=True)):
        try:
            low, high = (float(end) for end in pair)
        except (TypeError, ValueError):
            raise ValueError(f"bounds of axis {axis} are {pair!r}: give (lower, upper)") from None
        if is_whole and not (_is_whole(low) and _is_whole(high)):
            raise ValueError(f"bounds of axis {axis} are {pair!r}: an integer axis has whole ends below 2**53")
        axes.append((low, high, is_whole))
    return axes, labels


def _is_whole(number: float) -> bool:
    return abs(number) < _MOST and number == math.floor(number)


def _is_number(value: Any) -> bool:
    if hasattr(value, "ndim"):
        return bool(value.ndim == 0)
    return not hasattr(value, "__len__")


def _list(value: Any) -> list[Any]:
    if _is_number(value):
        return [value]
    return list(value)


def _real(name: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be a number, not {value!r}") from None


def _whole(name: str, value: Any, least: int = 1) -> int:
    if isinstance(value, float) and value.is_integer():
        value = int(value)  # 1e6
    try:
        number = value.__index__()
    except AttributeError:
        raise TypeError(f"{name} must be a whole number, not {value!r}") from None
    if not least <= number < 2**64:
        raise ValueError(f"{name} = {number} is not allowed: a whole number from {least} to 2**64 - 1")
    return int(number)


def _name(f: Any) -> str:
    name = getattr(f, "__qualname__", None) or type(f).__qualname__
    module = getattr(f, "__module__", None) or type(f).__module__
    return f"{module}.{name}" if module not in (None, "builtins") else str(name)
