"""`find`: a search in one call."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from . import _files, _satisfice
from ._arguments import question, run_arguments
from ._checked import exceptions, executor_of, workers_of
from ._search import Search


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
    patience: int | None = None,
    slices: int = 1,
    engine: str = "portfolio",
    options: Mapping[str, Any] | None = None,
    seed: int | None = None,
    probes: float | None = None,
    islands: int = 1,
    threads: int = 1,
    parallel: int | None = None,
    integrality: Any = None,
    logarithmic: Any = None,
    periodic: Any = None,
    categories: Mapping[int, Sequence[Any]] | None = None,
    permutations: Sequence[Sequence[int]] | None = None,
    x0: Any = None,
    components: int | None = None,
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
        (n, d) and values of shape (n,); with `components` it returns these, too. It is called on the calling thread, with a fresh float64 array that it may change.
        A value that is NaN or infinite is never a hit, and is counted. Or a problem of the catalogue (see `problem`),
        for which everything about the space (`bounds`, `separation`, `categories`, ...), `delta`, `x0`, `components`, `vectorized`,
        `workers`, `executor` and `catch` do not apply.
    bounds : sequence of (lower, upper), or scipy.optimize.Bounds
        The range of each axis, both ends included. ``None`` for an axis in `categories` or `permutations`.
    delta : float
        A hit is a point with f(x) < delta, strictly.
    separation : float or sequence of float, optional
        Hits within this Euclidean distance count as one, in units of the axes; with one number per axis, hits within the
        ellipsoid that has these half-axes (0 on an integer axis: different integers are different hits). On a `logarithmic`
        axis it is a distance of natural logarithms: 0.01 is about one percent. Without it,
        different coordinates are different hits: on continuous axes nearly every hit then is a new one.
    time : float, optional
        Wall time in seconds. `time`, `evaluations` or `patience` is required.
    evaluations : int, optional
        Evaluations. Candidates that are known already count, so that the search ends. With it and without `time`, the
        same seed gives the same report, apart from times, on the same platform.
    hits : int, optional
        Also end at this number of distinct hits.
    patience : int, optional
        Also end after this number of evaluations in succession without a new hit.
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
        For a problem of the catalogue: the threads that evaluate, 0 for one per core, at most 1,024. It does not change the report.
    parallel : int, optional
        How many evaluations can go on at once, from 1 to 65,536. The default engine and `surrogate` as a rule propose at least so many
        points at a time. Other engines do not look at it. Where they have an option ``batch``, that is how many they propose: 64
        for `random` and `branch-and-bound`, where so many are left, 1 for particle swarms. `niching`, `restarted-cma-es` and
        `bounded-swarms` propose a generation; `walk`, `descent`, `descent-flood` and `quadratic-descent` one point. Workers that are
        `ordered` wait where an engine proposes fewer points than there are workers; others always have one. `parallel` is part
        of the search, like a seed: the report depends on it, and not on how many workers there really are. By default 1; with
        `workers` given as a number and not `ordered`, that number.
    integrality : bool or sequence of bool, optional
        Which axes are integers (as in `scipy.optimize.differential_evolution`).
    logarithmic : bool or sequence of bool, optional
        Which axes are searched by their logarithm, for several orders of magnitude. Their lower ends are above 0; `f` gets
        the values themselves.
    periodic : bool or sequence of bool, optional
        Which axes are circles, such as angles: what leaves at one end enters at the other.
    categories : mapping of int to sequence, optional
        Labels of axes that are categories, without an order: ``{2: ["steel", "brass"]}``. `f` gets the index of the label.
    permutations : sequence of sequences of int, optional
        Groups of axes that follow each other and hold an order of the integers from 0 on: with ``[range(0, 5)]`` the first
        five coordinates are a permutation of 0 to 4.
    x0 : array-like of shape (d,) or (m, d), optional
        Points to evaluate first, inside the bounds: good guesses, or hits of another run. Engines start from the best ones.
    components : int, optional
        How many numbers `f` tells beside its value, all of which are near 0 at a hit: residuals of equations, errors of a design, how far
        a tool is from its goal along each axis. `f` then returns a tuple ``(value, components)``, of shape (components,), with `vectorized`
        ``(values, components)`` of shape (n, components). Each is divided by its limit, so that at every hit all of them are from
        -1 to 1: by `delta`, where the value is the largest magnitude or a norm; a hit with others is an error. NaN, where there is no such
        number, counts as far from 0. An engine that models `f` models each of them instead, and finds several times as many hits; others
        do not ask for them.
    vectorized : bool, default False
        Whether `f` takes all points of a batch at once.
    workers : int, map-like, or Executor, default 1
        Where `f` is evaluated: so many processes, a function such as ``pool.map``, or a `concurrent.futures.Executor` (Dask's,
        mpi4py's, ...). As `Search.run`; not with `callback` or `vectorized`.
    executor : int, Executor or Dask client, optional
        Where the islands run: an island and `f` with it, a round of it a task. For an `f` that is cheap beside what it costs
        to send a point away. A number starts so many processes. A round that is lost with its worker is run again elsewhere;
        under a budget of evaluations the report is that of the same islands on this process. Exceptions keep what was found
        until the last exchange of the islands. With one island, the same as `workers`.
    ordered : bool, default False
        With several workers: whether the report does not depend on the order of their values, nor on how many there are. Give
        `parallel` as well, or the ``batch`` of an engine that does not look at it, or they wait for each other. See `Search`.
    callback : callable, optional
        Called with a `Progress` at most about a hundred times a second; the search ends when it returns true.
    catch : exception type or tuple of them, default ()
        Exceptions of `f` that count as a value of NaN. They are counted in ``report.failed``, and nothing is proved with them; with
        `vectorized` an exception fails its whole batch.
    checkpoint : path, optional
        Keep the search in this file: at the beginning, after a second, then every five, and at the end, however it comes. A file
        that cannot be written at the beginning is an error; later it is a warning, and the search goes on. If
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
        For a value of `f` that is no real number, or is missing its components.
    RuntimeError
        With workers, for an exception of `f` that cannot be sent from process to process, with its text; and if the first 8 evaluations are
        all lost with their workers.
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
    workers, executor = workers_of(workers), executor_of(executor)
    if executor is not None:
        if not _is_one(workers):
            raise ValueError("workers evaluate, and an executor runs islands: give one of them")
        if islands == 1:
            workers, executor = executor, None
    if parallel is None and isinstance(workers, int) and not _is_one(workers) and not ordered:
        parallel = workers
    run = run_arguments(
        engine=engine,
        options=options,
        seed=seed,
        time=time,
        evaluations=evaluations,
        hits=hits,
        patience=patience,
        probes=probes,
        islands=islands,
        parallel=parallel,
        slices=slices,
        threads=threads,
    )
    if isinstance(f, _satisfice.Problem):
        given = {
            "bounds": bounds is not None,
            "delta": delta is not None,
            "separation": separation is not None,
            "integrality": integrality is not None,
            "logarithmic": logarithmic is not None,
            "periodic": periodic is not None,
            "categories": categories is not None,
            "permutations": permutations is not None,
            "x0": x0 is not None,
            "components": components is not None,
            "vectorized": vectorized,
            "catch": catch != (),
            "workers": not _is_one(workers),
            "executor": executor is not None,
        }
        for name, is_given in given.items():
            if is_given:
                raise ValueError(f"{name} does not apply: a problem of the catalogue has its own")
        with _writer(checkpoint) as writer:
            return f._run(run, told, reference, saved, writer)
    if not callable(f):
        raise TypeError(f"f must be callable or a satisfice.Problem, not {type(f).__name__}")
    for name, value, default in [("threads", threads, 1), ("slices", slices, 1), ("reference", reference, False)]:
        if value != default:
            raise ValueError(f"{name} applies to problems of the catalogue only; a function is called on the calling thread")
    catch = exceptions(catch)
    asked = question(
        _name(f),
        bounds,
        delta,
        separation,
        x0,
        components,
        integrality=integrality,
        logarithmic=logarithmic,
        periodic=periodic,
        categories=categories,
        permutations=permutations,
    )
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
        search = Search._begin(asked, run, ordered)
        if saved is not None:
            search._set(search._search.load_same(saved))
        on = {"executor": workers} if hasattr(workers, "submit") else {"workers": workers}
        return search.run(f, **on, catch=catch, checkpoint=checkpoint)
    with _writer(checkpoint) as writer:
        return _satisfice.find(f, asked, run, bool(vectorized), told, catch, saved, writer)


@contextlib.contextmanager
def _writer(path: str | os.PathLike[str] | None) -> Iterator[_files.Writer | None]:
    writer = None if path is None else _files.Writer(path)
    try:
        yield writer
    finally:
        if writer is not None:
            writer.end()


def _told(callback: Callable[[Progress], Any]) -> Callable[[int, int, float, float], bool]:
    return lambda evaluations, hits, time, share: bool(callback(Progress(evaluations, hits, time, share)))


def _is_one(workers: Any) -> bool:
    return isinstance(workers, int) and workers == 1


def _name(f: Any) -> str:
    name = getattr(f, "__qualname__", None) or type(f).__qualname__
    module = getattr(f, "__module__", None) or type(f).__module__
    return f"{module}.{name}" if module not in (None, "builtins") else str(name)
