"""`Search`: ask and tell, on as many workers as there are."""

from __future__ import annotations

import contextlib
import math
import os
import time as clock
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _satisfice
from ._arguments import question, run_arguments
from ._checked import exceptions, reals, seconds, ticket_numbers, whole, workers_of
from ._drive import Drive
from ._files import Keeper, write
from ._processes import Own
from ._workers import ExecutorLike, Guarded, Sent, assumed_workers, check_pickle, shaped


@dataclass(frozen=True, eq=False)
class Batch:
    """Points to evaluate, and the tickets under which their values are told.

    Attributes
    ----------
    x : ndarray of float64, shape (n, d)
        The points.
    tickets : ndarray of uint64, shape (n,)
        Their tickets.
    """

    x: NDArray[np.float64]
    tickets: NDArray[np.uint64]

    def __len__(self) -> int:
        return len(self.tickets)


class Search:
    """A search that gives out points under tickets and takes their values in any order.

    Parameters
    ----------
    bounds, delta, separation, evaluations, hits, patience, engine, options, seed, probes, islands, parallel, integrality, logarithmic, periodic, categories, permutations, x0, components
        As for `find`.
    time : float, optional
        Wall time in seconds from now on.
    ordered : bool, default False
        Whether values reach the engine in the order in which points were asked. Then the report under a budget of
        evaluations is that of `find` with the same seed, whatever the order of the values; but while values of a batch of
        the engine are awaited, nothing more can be asked: `parallel` says how large those of the default are at least. Otherwise there is
        always more to ask, and the report depends on the order of the values.

    Examples
    --------
    >>> import satisfice
    >>> search = satisfice.Search([(-5, 5)] * 2, delta=1.0, separation=0.5, evaluations=2000, seed=1)
    >>> while len(batch := search.ask(16)):
    ...     search.tell(batch.tickets, (batch.x**2).sum(axis=1))
    >>> search.report().hits > 5
    True
    """

    def __init__(
        self,
        bounds: Any,
        *,
        delta: float,
        separation: float | Sequence[float] | None = None,
        time: float | None = None,
        evaluations: int | None = None,
        hits: int | None = None,
        patience: int | None = None,
        engine: str = "portfolio",
        options: Any = None,
        seed: int | None = None,
        probes: float | None = None,
        islands: int = 1,
        parallel: int | None = None,
        integrality: Any = None,
        logarithmic: Any = None,
        periodic: Any = None,
        categories: Any = None,
        permutations: Any = None,
        x0: Any = None,
        components: int | None = None,
        ordered: bool = False,
        name: str = "function",
    ) -> None:
        self._search = _satisfice.Search(
            question(
                name,
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
            ),
            run_arguments(
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
            ),
            bool(ordered),
        )
        self._deadline = math.inf if time is None else clock.monotonic() + float(time)

    @classmethod
    def _begin(cls, question: dict[str, Any], run: dict[str, Any], ordered: bool) -> Search:
        search = cls.__new__(cls)
        search._search = _satisfice.Search(question, run, bool(ordered))
        search._deadline = math.inf if run["time"] is None else clock.monotonic() + run["time"]
        return search

    def ask(self, n: int = 1) -> Batch:
        """At most `n` points to evaluate.

        Fewer if others have to be answered first or if the budget is given out; none while nothing is `pending` means that
        the search is over. Unless `ordered`, at most 65,536 points are pending at a time, fewer with more than 1,024 axes.
        After `load`, points that were pending come first, under their tickets.
        """
        tickets, x = self._search.ask(whole("n", n, least=0))
        return Batch(x, tickets)

    def tell(self, tickets: ArrayLike, values: ArrayLike, components: ArrayLike | None = None) -> None:
        """Tell values, shape (m,), of tickets, shape (m,): any part of those asked, in any order. A search with `components` is told
        those as well, shape (m, components).

        NaN and infinite values are counted and never hits. A second value for a ticket, and one for a forgotten ticket, are
        counted and dropped.

        Raises
        ------
        ValueError
            For a ticket that was never given out; for components that are missing, too many, or not those of a hit.
        """
        self._search.tell(ticket_numbers(tickets), _numbers(values), _rows(components))

    def fail(self, tickets: ArrayLike) -> None:
        """Tell that the evaluations of tickets gave no value. They count as NaN, use up budget, and are counted in ``report.failed``:
        each may have been a hit, so that nothing is proved. A value of NaN says that a point is no hit."""
        for ticket in ticket_numbers(tickets).tolist():
            self._search.fail(ticket)

    def forget(self, tickets: ArrayLike) -> None:
        """Give up points whose evaluations were lost. They use up no budget."""
        self._search.forget(ticket_numbers(tickets))

    def inform(self, x: ArrayLike, values: ArrayLike, components: ArrayLike | None = None) -> None:
        """Enter values, shape (m,), at points, shape (m, d), that are known from elsewhere, with their components if the search has some.
        They use up no budget."""
        self._search.inform(
            np.atleast_2d(reals("x", x)), _numbers(values), _rows(components)
        )

    @property
    def pending(self) -> Batch:
        """Points that were asked and neither told nor forgotten."""
        tickets, x = self._search.pending()
        return Batch(x, tickets)

    @property
    def hits(self) -> int:
        """The number of distinct hits so far."""
        return self._search.hits()

    @property
    def counts(self) -> dict[str, int]:
        """Tickets: ``asked``, ``taken``, ``unused`` (taken and dropped, because an earlier value of the batch ended the slice by a limit
        of hits or by patience), ``again`` (a second value), ``late`` (after `forget`), ``over`` (after such an end) and ``forgotten``."""
        return self._search.ticket_counts()

    def report(self) -> _satisfice.Report:
        """The report as it is now; the search can go on."""
        return self._search.report()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the search to a file, from which `load` continues it. It replaces the file when all is written; a link is written
        through, a device or a pipe in place."""
        write(path, self._search.save())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Search:
        """Read a search that `save` wrote. Points that were pending are asked again, under their tickets."""
        with open(path, "rb") as file:
            return cls._from_bytes(file.read())

    @classmethod
    def _from_bytes(cls, state: bytes) -> Search:
        search = cls.__new__(cls)
        search._set(_satisfice.Search.load(state))
        return search

    def _set(self, search: _satisfice.Search) -> None:
        """Be this search, which was saved."""
        self._search = search
        report = search.report()
        limit = report.to_dict()["budget"]["time_seconds"]
        self._deadline = math.inf if limit is None else clock.monotonic() + limit - report.elapsed

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        return Search._from_bytes, (self._search.save(),)

    def run(
        self,
        f: Callable[[Any], Any],
        *,
        executor: ExecutorLike | None = None,
        workers: int | Callable[..., Iterable[Any]] = 1,
        in_flight: int | None = None,
        time: float | None = None,
        catch: type[BaseException] | tuple[type[BaseException], ...] = (),
        checkpoint: str | os.PathLike[str] | None = None,
    ) -> _satisfice.Report:
        """Evaluate `f` on workers until the search is over. Points that are pending come first.

        Parameters
        ----------
        f : callable
            ``f(x) -> float`` with `x` of shape (d,). It is sent to the workers as these do it: processes need a function at
            the top level of a module.
        executor : Executor, optional
            A `concurrent.futures.Executor` or anything with ``submit``: a Dask client or its ``get_executor()``,
            `mpi4py.futures.MPIPoolExecutor`, ...
        workers : int or map-like, default 1
            Without `executor`: the number of processes, 1 for none but this one; one that dies is replaced, and what it had is evaluated again. Or a
            function such as ``pool.map`` or ``pool.imap``, which is given one batch after the other, and gives its values in the same order.
        in_flight : int, optional
            The number of points out at a time. By default the number of workers; with a number of processes, twice as many if
            evaluations take less than 0.1 s. The executors of `concurrent.futures`, the pools of `multiprocessing`, loky, mpi4py and
            Dask say how many workers they have; for others it is the number of CPUs of this machine, so give it where the workers
            are on other machines. More than there are workers costs hits: the engine proposes points before it knows the values
            of those that wait. With a Dask client each worker by default has one task and another one waiting, of up to 8
            points if these take less than 50 ms together.
        time : float, optional
            Stop after so many seconds; what is out then stays pending.
        catch : exception type or tuple of them
            Exceptions of `f` that count as a value of NaN and in ``report.failed``: then nothing is proved.
        checkpoint : path, optional
            Save the search to this file at the beginning, after a second, then every five, and at the end, however it comes.
            `load` reads it. If it cannot be written at the beginning, that is an error; later it is a warning, and the search goes on.

        Returns
        -------
        Report

        Raises
        ------
        KeyboardInterrupt, or an exception of `f` or of the executor
            What was found until then is its attribute ``report``. The search can go on: what was out is pending.
        RuntimeError
            For an exception of `f` that cannot be sent from its process to this one, with its text; and if the first 8 evaluations
            are all lost with their workers. An evaluation that is lost three times counts as failed otherwise.
        """
        catch = exceptions(catch)
        workers = workers_of(workers)
        if executor is not None and workers != 1:
            raise ValueError("both workers= and executor= say where f is evaluated: give one of them")
        if in_flight is not None:
            in_flight = whole("in_flight", in_flight)
        time = seconds(time)
        deadline = math.inf if time is None else clock.monotonic() + time
        deadline = min(deadline, self._deadline)
        keeper = Keeper(checkpoint, self._search.save)
        try:
            if executor is None and workers == 1:
                self._map(f, map, 1, deadline, catch, keeper)
            elif executor is None and not isinstance(workers, int):
                self._map(f, workers, in_flight or assumed_workers(workers), deadline, catch, keeper)
            elif executor is not None:
                pool, known = shaped(executor)
                if in_flight or not known or not pool.is_far:
                    Drive(self, f, pool, in_flight or known or assumed_workers(executor), deadline, catch, keeper).run()
                else:
                    Drive(self, f, pool, 2 * known, deadline, catch, keeper, workers=known).run()
            elif isinstance(workers, int):
                check_pickle(f)
                with Own(workers) as own:
                    drive = Drive(self, f, own, in_flight or workers, deadline, catch, keeper)
                    drive.prefetch = 0 if in_flight else workers
                    drive.run()
            if clock.monotonic() >= self._deadline:
                self._end()
            keeper.end()
        except BaseException as error:
            with contextlib.suppress(AttributeError):
                error.report = self.report()  # type: ignore[attr-defined]
                error.add_note("satisfice: what was found until then is in the attribute `report` of this exception")
            keeper.end_with(error)
            raise
        return self.report()

    def _end(self) -> None:
        """Note that the time is up: what comes now is late."""
        self.forget(self.pending.tickets)
        self.forget(self.ask(1).tickets)

    def _map(
        self,
        f: Callable[[Any], Any],
        map_: Callable[..., Iterable[Any]],
        size: int,
        deadline: float,
        catch: tuple[type[BaseException], ...],
        keeper: Keeper,
    ) -> None:
        """Evaluate one batch after the other."""
        guarded = Sent(Guarded(f, catch, self._search.components()))
        batch = self.pending
        while True:
            if len(batch) == 0:
                batch = self.ask(size)
            if len(batch) == 0 or clock.monotonic() >= deadline:
                return
            values = list(map_(guarded, [x.copy() for x in batch.x]))
            if len(values) != len(batch):
                raise ValueError(f"the map gave {len(values)} values for {len(batch)} points")
            for ticket, value in zip(batch.tickets.tolist(), values, strict=True):
                self._take(ticket, value)
            keeper.save_if_due()
            batch = self.ask(0)

    def _take(self, ticket: int, value: Any) -> None:
        """Tell a value of `Guarded`."""
        if value is None:
            self._search.fail(ticket)
        elif isinstance(value, tuple):
            self.tell([ticket], [value[0]], [value[1]])
        else:
            self.tell([ticket], [value])


def _numbers(values: ArrayLike) -> NDArray[np.float64]:
    array = np.atleast_1d(reals("values", values))
    if array.ndim != 1:
        raise ValueError(f"values have shape {array.shape}: they need shape (m,), one for each ticket or point")
    return array


def _rows(components: ArrayLike | None) -> NDArray[np.float64] | None:
    return None if components is None else np.atleast_2d(reals("components", components))
