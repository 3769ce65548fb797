"""How a search keeps workers busy: points go out, values come back in any order, what is lost goes out again."""

from __future__ import annotations

import collections
import concurrent.futures as futures
import contextlib
import math
import queue
import time as clock
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._files import Keeper
from ._processes import Own
from ._workers import LOOK_EVERY, MOST_LOSSES, Given, Guarded, Sent, is_killed

if TYPE_CHECKING:
    from ._search import Search

#: Seconds of an evaluation that is short beside what it costs to wait for the next point.
_SHORT = 0.1
#: Seconds that a task takes where one costs milliseconds to send, and the most points in it.
_TASK = 0.05
_MOST_POINTS = 8

#: Where so many evaluations are lost with their workers before one gives a value, none will. As for programs of the command.
_HOPELESS = 8

#: A ticket and its point.
_Point = tuple[int, NDArray[np.float64]]


class Drive:
    """Keeps an executor busy.

    At most `tasks` tasks are out, of one point each. With `workers`, whose number is known, a task has more points if their evaluations are
    short: each worker is sent as many as it evaluates in 50 ms.
    """

    def __init__(
        self,
        search: Search,
        f: Callable[[Any], Any],
        pool: Given | Own,
        tasks: int,
        deadline: float,
        catch: tuple[type[BaseException], ...],
        keeper: Keeper,
        workers: int | None = None,
    ) -> None:
        self.search, self.pool, self.tasks, self.deadline = search, pool, tasks, deadline
        self.keeper, self.workers = keeper, workers
        #: Points in a task.
        self.size = 1
        #: So many more tasks are out if evaluations are so short that workers would wait for the next.
        self.prefetch = 0
        self.f = Sent(Guarded(f, catch, search._search.components()).all)
        self.done: queue.SimpleQueue[Any] = queue.SimpleQueue()
        #: Points, generation of the pool and start by future; and the number of these points.
        self.out: dict[Any, tuple[list[_Point], int, float]] = {}
        self.points_out = 0
        pending = search.pending
        self.waiting: list[_Point] = list(zip(pending.tickets.tolist(), pending.x, strict=True))
        self.known = set(pending.tickets.tolist())
        #: Points that were out when a worker died. One at a time, so that it is seen which one kills its worker.
        self.suspects: list[_Point] = []
        self.losses: collections.Counter[int] = collections.Counter()
        #: Evaluations that were given up, and whether any gave a value.
        self.given_up, self.has_value = 0, search._search.evaluations() > 0

    def run(self) -> None:
        try:
            while self._fill() and clock.monotonic() < self.deadline:
                self.keeper.save_if_due()
                done = self._wait()
                for future, outcome in zip(done, self.pool.outcomes(done), strict=True):
                    self._take(future, outcome)
        finally:
            for future in self.out:
                future.cancel()

    def _wait(self) -> list[Any]:
        """What is done; after a while, nothing."""
        done = []
        with contextlib.suppress(queue.Empty):
            done.append(self.done.get(timeout=LOOK_EVERY))
            while True:
                done.append(self.done.get_nowait())
        return [future for future in done if future in self.out]

    def _fill(self) -> bool:
        """Give out as much as there is room for; whether anything is out."""
        if self.suspects:
            if not self.out:
                self._submit([self.suspects.pop()])
            return True
        room = max(0, self.tasks * self.size - self.points_out)
        points, self.waiting = self.waiting[:room], self.waiting[room:]
        if room > len(points):
            batch = self.search.ask(room - len(points))
            asked = zip(batch.tickets.tolist(), batch.x, strict=True)
            # What was pending when the search was loaded is asked again.
            points += [(ticket, x) for ticket, x in asked if ticket not in self.known]
        size = self.size
        if self.workers is not None and len(self.out) < self.workers:
            size = min(size, math.ceil(len(points) / (self.workers - len(self.out))) or 1)
        for first in range(0, len(points), size):
            self._submit(points[first : first + size])
        return bool(self.out)

    def _submit(self, points: list[_Point]) -> None:
        x = [x.copy() for _, x in points]
        try:
            future = self.pool.submit(self.f, x)
        except futures.BrokenExecutor as error:
            self.pool.replace(error)
            future = self.pool.submit(self.f, x)
        self.out[future] = (points, self.pool.generation, clock.monotonic())
        self.points_out += len(points)
        future.add_done_callback(self.done.put)

    def _take(self, future: Any, outcome: Any) -> None:
        points, generation, begun = self.out.pop(future)
        alone = not self.out and len(points) == 1
        self.points_out -= len(points)
        if self.prefetch and clock.monotonic() - begun < _SHORT:
            self.tasks, self.prefetch = self.tasks + self.prefetch, 0
        if isinstance(outcome, (futures.BrokenExecutor, futures.CancelledError)):
            if generation == self.pool.generation:
                self.pool.replace(outcome)
            self._lost(points, alone, outcome)
        elif isinstance(outcome, Exception):
            if not is_killed(outcome):
                raise outcome
            self._lost(points, alone, outcome)
        else:
            values, seconds = outcome
            self.has_value = True
            for (ticket, _), value in zip(points, values, strict=True):
                self.search._take(ticket, value)
            if self.workers is not None:
                short = seconds / len(points)
                self.size = max(1, min(_MOST_POINTS, round(_TASK / max(short, 1e-9))))

    def _lost(self, points: list[_Point], alone: bool, error: BaseException) -> None:
        """Evaluate points again that were lost with their worker, unless one has killed several. An exception if all do."""
        for ticket, x in points:
            self.losses[ticket] += alone
            if self.losses[ticket] >= MOST_LOSSES:
                self.given_up += 1
                if self.given_up >= _HOPELESS and not self.has_value:
                    raise RuntimeError(
                        f"the first {self.given_up} evaluations all failed: each ended every worker that it was sent to; "
                        "f exits or crashes there, or cannot be loaded there"
                    ) from error
                self.search._take(ticket, None)
            else:
                self.suspects.append((ticket, x))
