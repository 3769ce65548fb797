"""Islands in other processes: each round of an island is a task for an executor."""

from __future__ import annotations

import collections
import concurrent.futures as futures
import contextlib
import functools
import math
import os
import queue
import time as clock
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _satisfice
from ._checked import reals
from ._files import Keeper
from ._processes import Own
from ._workers import LOOK_EVERY, MOST_LOSSES, Given, Guarded, Sent, check_pickle, is_killed, pair, shaped

#: After the deadline islands that end by themselves are waited for: so long, in seconds, or this share of the time.
_GRACE, _GRACE_SHARE = 1.0, 0.1


def find_with_islands(
    f: Callable[[Any], Any],
    question: dict[str, Any],
    run: dict[str, Any],
    executor: Any,
    *,
    vectorized: bool,
    told: Callable[[int, int, float, float], bool] | None,
    catch: tuple[type[BaseException], ...],
    checkpoint: str | os.PathLike[str] | None,
    saved: bytes | None,
) -> _satisfice.Report:
    """Search with the islands on an executor, or on so many processes. The report is that of islands on this process."""
    rounds = _satisfice.Rounds(question, run, saved)
    plan = rounds.plan()
    keeper = Keeper(checkpoint, rounds.save)
    limit = math.inf if run["time"] is None else run["time"] - rounds.progress()[2]
    latest = clock.monotonic() + limit + max(_GRACE, _GRACE_SHARE * limit)

    def island(number: int) -> tuple[Any, ...]:
        return Sent(_run_island), f, plan, rounds.island(number), vectorized, catch

    def probes(part: NDArray[np.float64]) -> tuple[Any, ...]:
        return Sent(_evaluate), f, part, vectorized, catch, question["components"]

    def stops() -> bool:
        keeper.save_if_due()
        if told is None:
            return False
        evaluations, hits, time = rounds.progress()
        shares = [part / whole for part, whole in [(evaluations, run["evaluations"]), (time, run["time"])] if whole]
        return told(evaluations, hits, time, min(1.0, max(shares, default=0.0)))

    with contextlib.ExitStack() as stack:
        if isinstance(executor, int):
            check_pickle(f)
            pool: Own | Given = stack.enter_context(Own(executor))
            workers: int | None = executor
        else:
            pool, workers = shaped(executor)
        crew = _Crew(pool, workers or run["islands"], latest)
        try:
            while due := rounds.round():
                if stops():
                    rounds.end("observer")
                    break
                for _, (state, failed) in crew.run({number: functools.partial(island, number) for number in due}):
                    rounds.take(state, failed)
                    keeper.save_if_due()
            while len(points := rounds.probes()):
                parts = np.array_split(points, min(len(points), run["islands"]))
                answers = dict(crew.run({number: functools.partial(probes, part) for number, part in enumerate(parts)}))
                values = np.concatenate([answers[number][0] for number in range(len(parts))])
                rounds.tell_probes(values, sum(failed for _, failed in answers.values()))
            keeper.end()
        except _TimeIsUp:
            keeper.end()
            rounds.end("time")
        except BaseException as error:
            keeper.end_with(error)
            rounds.end("cancelled")
            with contextlib.suppress(AttributeError):
                error.report = rounds.report()  # type: ignore[attr-defined]
                error.add_note("satisfice: what was found until then is in the attribute `report` of this exception")
            raise
    return rounds.report()


def _run_island(
    f: Callable[[Any], Any], plan: bytes, state: bytes, vectorized: bool, catch: tuple[type[BaseException], ...]
) -> tuple[bytes, int]:
    """Run an island for a round, in the process of a worker."""
    return _satisfice.run_island(f, plan, state, vectorized, catch)


def _evaluate(
    f: Callable[[Any], Any],
    points: NDArray[np.float64],
    vectorized: bool,
    catch: tuple[type[BaseException], ...],
    components: int,
) -> tuple[NDArray[np.float64], int]:
    """Values at points, without components, and how many were lost to exceptions that are caught."""
    if vectorized:
        try:
            found = f(points.copy())
        except catch:
            return np.full(len(points), np.nan), len(points)
        values = pair(found, components)[0] if components else found
        return reals("values of f", np.ma.filled(values, math.nan)).reshape(len(points)), 0
    guarded = Guarded(f, catch, components)
    known, lost = np.full(len(points), math.nan), 0
    for index, x in enumerate(points):
        value = guarded(x.copy())
        if value is None:
            lost += 1
        else:
            known[index] = value[0] if isinstance(value, tuple) else value
    return known, lost


class _TimeIsUp(Exception):
    """The time of the search is over, and something is still out."""


class _Crew:
    """Runs jobs on a pool, those that were lost with a worker again."""

    def __init__(self, pool: Own | Given, in_flight: int, latest: float) -> None:
        self.pool, self.in_flight, self.latest = pool, in_flight, latest

    def run(self, jobs: Mapping[int, Callable[[], tuple[Any, ...]]]) -> Iterator[tuple[int, Any]]:
        """Results by key, as they come. A job is made when there is room for it: a function and its arguments."""
        waiting = collections.deque(jobs)
        losses: collections.Counter[int] = collections.Counter()
        out: dict[Any, tuple[int, int]] = {}
        done: queue.SimpleQueue[Any] = queue.SimpleQueue()

        def lost(key: int, generation: int, error: BaseException) -> None:
            losses[key] += 1
            if losses[key] >= MOST_LOSSES:
                raise error
            if generation == self.pool.generation:
                self.pool.replace(error)
            waiting.append(key)

        try:
            while waiting or out:
                while waiting and len(out) < self.in_flight:
                    key = waiting.popleft()
                    generation = self.pool.generation
                    try:
                        future = self.pool.submit(*jobs[key]())
                    except futures.BrokenExecutor as error:
                        lost(key, generation, error)
                        continue
                    out[future] = (key, generation)
                    future.add_done_callback(done.put)
                if clock.monotonic() >= self.latest:
                    raise _TimeIsUp
                try:
                    future = done.get(timeout=LOOK_EVERY)
                except queue.Empty:
                    continue
                key, generation = out.pop(future)
                try:
                    result = future.result()
                except (futures.BrokenExecutor, futures.CancelledError) as error:
                    lost(key, generation, error)
                    continue
                except Exception as error:
                    if not is_killed(error):
                        raise
                    lost(key, generation, error)
                    continue
                yield key, result
        finally:
            for future in out:
                future.cancel()
