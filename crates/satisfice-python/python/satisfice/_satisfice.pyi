"""Native part of the package `satisfice`."""

from collections.abc import Callable
from os import PathLike
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Best",
    "Body",
    "Mesh",
    "Problem",
    "Report",
    "Rounds",
    "Search",
    "Step",
    "World",
    "close_pairs",
    "command",
    "find",
    "listing",
    "run_island",
    "saved_seed",
    "version",
]

def version() -> str:
    """The version of the framework."""

def listing() -> str:
    """Every engine and problem with its parameters, as the JSON of `satisfice list --json`."""

def command(arguments: list[str]) -> int:
    """Run the command; the first argument is the name of the program.

    Returns
    -------
    int
        The exit code.
    """

def find(
    function: Callable[[Any], Any],
    question: dict[str, Any],
    run: dict[str, Any],
    vectorized: bool,
    callback: Callable[[int, int, float, float], bool] | None,
    catch: tuple[type[BaseException], ...],
    saved: bytes | None,
    save: Callable[[bytes], None] | None,
) -> Report:
    """Search a function; `satisfice.find` is the way to call it."""

def saved_seed(bytes: bytes) -> int:
    """The seed of a saved search."""

def run_island(
    function: Callable[[Any], Any],
    plan: bytes,
    island: bytes,
    vectorized: bool,
    catch: tuple[type[BaseException], ...],
) -> tuple[bytes, int]:
    """Run an island for a round: what it then is, and how many values were lost to exceptions that were caught."""

@final
class Rounds:
    """A search whose islands run elsewhere; `satisfice.find` with an executor uses it."""

    def __new__(cls, question: dict[str, Any], run: dict[str, Any], saved: bytes | None) -> Rounds: ...
    def plan(self) -> bytes: ...
    def round(self) -> list[int]: ...
    def island(self, island: int) -> bytes: ...
    def take(self, done: bytes, failed: int) -> None: ...
    def probes(self) -> NDArray[np.float64]: ...
    def tell_probes(self, values: NDArray[np.float64], failed: int) -> None: ...
    def end(self, reason: str) -> None: ...
    def progress(self) -> tuple[int, int, float]: ...
    def save(self) -> bytes: ...
    def report(self) -> Report: ...

@final
class Problem:
    """A problem of the catalogue with its parameters set; `satisfice.problem` makes it."""

    def __new__(cls, name: str, given: list[tuple[str, str]]) -> Problem: ...
    @property
    def name(self) -> str:
        """Its name in the catalogue."""
    def reference_hits(self) -> int | None:
        """The number of all hits, where it is known. May take long; Ctrl-C ends the wait."""
    def _parameters(self) -> str: ...
    def _run(
        self,
        run: dict[str, Any],
        callback: Callable[[int, int, float, float], bool] | None,
        reference: bool,
        saved: bytes | None,
        save: Callable[[bytes], None] | None,
    ) -> Report: ...
    def __reduce__(self) -> tuple[Any, tuple[str, list[tuple[str, str]]]]: ...

@final
class Best:
    """The candidate with the least value, hit or not."""

    @property
    def x(self) -> Any:
        """Its coordinates, shape (d,); the solution itself where solutions are no points."""
    @property
    def fun(self) -> float:
        """Its value."""
    @property
    def evaluation(self) -> int:
        """The evaluation that found it, counted from 1; 0 if `inform` told it."""

@final
class Report:
    """What a search did and found: plain data that can be pickled, and written and read as JSON.

    Its length is the number of hits. Arrays are made once and kept.
    """

    @classmethod
    def from_json(cls, text: str) -> Report:
        """The report of a JSON text that `to_json` or ``satisfice run --json`` wrote.

        Raises
        ------
        ValueError
            For any other text.
        """
    def to_json(self, path: str | PathLike[str] | None = None) -> str | None:
        """The report as JSON, as the command writes it.

        Parameters
        ----------
        path : path, optional
            Write to this file and return nothing.
        """
    def to_dict(self) -> dict[str, Any]:
        """The content of `to_json` as a dict."""
    def to_pandas(self) -> Any:
        """The hits as a `pandas.DataFrame`: a column per axis (``x0``, ``x1``, ...), ``fun``, ``evaluation``, ``time``.

        Raises
        ------
        ImportError
            Without pandas.
        """
    @property
    def x(self) -> NDArray[np.float64]:
        """Coordinates of the hits in the order found, shape (n, d).

        Raises
        ------
        ValueError
            For a problem whose solutions are no points or lists of numbers; see `solutions`.
        """
    @property
    def fun(self) -> NDArray[np.float64]:
        """Values of the hits, shape (n,)."""
    @property
    def evaluation(self) -> NDArray[np.uint64]:
        """The evaluation that found each hit, counted from 1, shape (n,); 0 for those that `inform` told."""
    @property
    def time(self) -> NDArray[np.float64]:
        """When each hit was found, in seconds from the start, shape (n,)."""
    @property
    def solutions(self) -> list[Any]:
        """The hits as plain Python values, as they stand in the JSON."""
    @property
    def best(self) -> Best | None:
        """The candidate with the least finite value, hit or not."""
    @property
    def trace(self) -> dict[str, NDArray[Any]]:
        """Distinct hits against evaluations and seconds: arrays ``evaluations``, ``time`` and ``hits``."""
    @property
    def hits(self) -> int:
        """The number of distinct hits."""
    @property
    def evaluations(self) -> int:
        """Candidates that used up the budget, those that were known included. Bounds of a problem of the catalogue use it up, too: `to_dict` has
        them as ``bound_calls``."""
    @property
    def nfev(self) -> int:
        """Calls of the function, a point each."""
    @property
    def duplicates(self) -> int:
        """Candidates that were known hits."""
    @property
    def non_finite(self) -> int:
        """Values that were NaN or infinite."""
    @property
    def failed(self) -> int:
        """Evaluations that gave no value: exceptions that were caught, tickets that failed. They are among `non_finite`; where there are
        any, `completeness` is never ``Proved``."""
    @property
    def seed(self) -> int:
        """The seed, given or drawn."""
    @property
    def engine(self) -> str:
        """Name of the engine."""
    @property
    def problem(self) -> str:
        """Name of the problem; ``"function"`` for a function."""
    @property
    def delta(self) -> float:
        """A hit is a point with f(x) < delta."""
    @property
    def elapsed(self) -> float:
        """Wall time in seconds."""
    @property
    def stop_reason(self) -> str:
        """Why the search ended: ``"Time"``, ``"Evaluations"``, ``"Hits"``, ``"Patience"``, ``"Cancelled"`` (a signal, an exception; or it goes on),
        ``"Observer"`` (the callback), ``"Exhausted"`` (the engine has no more to propose), ``"Covered"`` (the whole space)."""
    @property
    def completeness(self) -> str:
        """``"Proved"`` if all hits are known to be listed, else ``"Unknown"``."""
    @property
    def unseen_estimate(self) -> float | None:
        """The estimated number of hits not seen, by uniform probes: without `probes` the engine's own few, or ``None``. See `unseen_interval`."""
    @property
    def unseen_interval(self) -> tuple[float, float | None] | None:
        """The interval of `unseen_estimate`; no upper end where nothing bounds it."""
    @property
    def reference_hits(self) -> int | None:
        """The number of all hits, where it is known and was asked for."""
    @property
    def recall(self) -> float | None:
        """``hits / reference_hits``."""
    def __len__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, tuple[str]]: ...

_Pose = tuple[tuple[float, ...], tuple[float, ...]] | None
_Column = NDArray[np.uint32]
_Vectors = NDArray[np.float64]

def close_pairs(
    a: Mesh,
    b: Mesh | None,
    pairs: str,
    delta: float,
    poses: tuple[_Pose, _Pose],
    ring: int,
    witnesses: bool,
    time: float | None,
    limit: int | None,
    threads: int,
) -> tuple[_Column, _Column, NDArray[np.float64], tuple[_Vectors, _Vectors] | None, bool]:
    """All close pairs; `satisfice.collision.close_pairs` is the way to call it."""

@final
class Mesh:
    """A checked mesh with its search trees; `satisfice.collision.mesh` makes it."""

    def __new__(
        cls, vertices: _Vectors, faces: NDArray[np.int64] | None = None, edges: NDArray[np.int64] | None = None
    ) -> Mesh: ...
    @property
    def vertices(self) -> _Vectors:
        """Positions of the vertices, shape (n, 3)."""
    @property
    def faces(self) -> NDArray[np.uint32]:
        """The triangles by their vertices, shape (m, 3)."""
    def __reduce__(self) -> tuple[type[Mesh], tuple[_Vectors, NDArray[np.int64], NDArray[np.int64]]]: ...

@final
class Body:
    """A handle of a body in its world. Equal handles name one body."""

    @property
    def index(self) -> int:
        """Its place in the world: 0, 1, 2, ... in the order of addition. The place of a removed body is given to another."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class World:
    """Native part of `satisfice.collision.World`."""

    def __new__(cls, pairs: str, delta: float, threads: int) -> World: ...
    def add(
        self, mesh: Mesh, motion: str, pose: _Pose, groups: tuple[int, int], self_collision: bool, ring: int
    ) -> Body: ...
    def place(self, body: Body, pose: _Pose) -> None: ...
    def translate(self, body: Body, translation: tuple[float, ...]) -> None: ...
    def deform(self, body: Body, vertices: _Vectors) -> None: ...
    def remove(self, body: Body) -> None: ...
    def replace(self, body: Body, mesh: Mesh) -> None: ...
    def set_groups(self, body: Body, groups: int, mask: int) -> None: ...
    def exclude(self, a: Body, b: Body) -> None: ...
    def include(self, a: Body, b: Body) -> None: ...
    def threshold(self) -> float: ...
    def set_threshold(self, delta: float) -> None: ...
    def __len__(self) -> int: ...
    def bodies(self) -> list[Body]: ...
    def update(self, time: float | None, limit: int | None) -> tuple[bool, int, list[tuple[str, int]]]: ...
    def contacts(self, measured: bool) -> tuple[list[_Column], NDArray[np.float64] | None]: ...
    def changes(self) -> tuple[list[_Column], list[str]]: ...
    def touching(self, time: float | None) -> tuple[list[tuple[Body, Body]], bool]: ...
    def first(self, time: float | None) -> tuple[tuple[int, int, int, int] | None, bool]: ...
    def nearest(
        self, count: int, time: float | None
    ) -> tuple[tuple[list[_Column], NDArray[np.float64], _Vectors, _Vectors], bool]: ...
    def distance(self, a: Body, b: Body) -> tuple[int, int, int, int, float, list[float], list[float]] | None: ...
    def nearest_to_point(self, point: tuple[float, ...]) -> tuple[Body, int, float, list[float]] | None: ...
    def cast_ray(
        self, from_: tuple[float, ...], to: tuple[float, ...]
    ) -> tuple[Body, int, float, list[float]] | None: ...
    def bodies_in(self, min: tuple[float, ...], max: tuple[float, ...]) -> list[Body]: ...

@final
class Step:
    """Native part of `satisfice.collision.Step`."""

    def __new__(cls) -> Step: ...
    def add(self, mesh: Mesh, to: _Vectors, self_collision: bool) -> int: ...
    def set_motion(self, body: int, start: _Vectors, end: _Vectors) -> None: ...
    def impacts(
        self, pairs: str | None, delta: float, tolerance: float, time: float | None, threads: int
    ) -> tuple[list[_Column], list[NDArray[np.float64]], list[_Vectors], list[tuple[str, int]], bool]: ...
    def earliest(
        self, delta: float, tolerance: float, time: float | None
    ) -> tuple[list[float], tuple[str, list[int]] | None, bool]: ...
    def free_step(self, delta: float, time: float | None) -> float: ...

@final
class Search:
    """Native part of `satisfice.Search`."""

    def __new__(cls, question: dict[str, Any], run: dict[str, Any], ordered: bool) -> Search: ...
    def ask(self, count: int) -> tuple[NDArray[np.uint64], _Vectors]: ...
    def tell(
        self, tickets: NDArray[np.uint64], values: NDArray[np.float64], components: NDArray[np.float64] | None
    ) -> None: ...
    def fail(self, ticket: int) -> None: ...
    def forget(self, tickets: NDArray[np.uint64]) -> None: ...
    def inform(
        self, points: _Vectors, values: NDArray[np.float64], components: NDArray[np.float64] | None
    ) -> None: ...
    def open(self) -> int: ...
    def pending(self) -> tuple[NDArray[np.uint64], _Vectors]: ...
    def hits(self) -> int: ...
    def evaluations(self) -> int: ...
    def ticket_counts(self) -> dict[str, int]: ...
    def report(self) -> Report: ...
    def dimension(self) -> int: ...
    def components(self) -> int: ...
    def save(self) -> bytes: ...
    @classmethod
    def load(cls, bytes: bytes) -> Search: ...
    def load_same(self, bytes: bytes) -> Search: ...
