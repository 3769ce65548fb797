"""Impacts during a step, in which every vertex moves along a straight line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _satisfice
from .._checked import real, seconds, whole
from ._mesh import mesh, vertices_of


@dataclass(frozen=True, eq=False)
class Impacts:
    """Pairs of features that come near each other during a step: those of vertices and triangles first, then those of edges, each in
    ascending order.

    Attributes
    ----------
    kind : ndarray of str, shape (m,)
        The kind of each pair, as `Step.impacts` takes it.
    body_a, body_b, a, b : ndarray of uint32, shape (m,)
        Bodies in the order of adding, and features of their meshes.
    time : ndarray of float64, shape (m, 2)
        A lower and an upper bound of the time of impact, both proved; 0 is the start of the step and 1 its end.
    point_a, point_b, normal : ndarray of float64, shape (m, 3)
        Closest points at the upper bound, and a unit vector from the first feature towards the second at about that time (0
        where the features leave it open).
    complete : bool
        Whether these are all.
    """

    body_a: NDArray[np.uint32]
    body_b: NDArray[np.uint32]
    a: NDArray[np.uint32]
    b: NDArray[np.uint32]
    time: NDArray[np.float64]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    normal: NDArray[np.float64]
    kind: NDArray[np.str_]
    complete: bool

    def __len__(self) -> int:
        return len(self.a)


class Step:
    """Meshes that move from one frame to the next, every vertex along a straight line at constant speed.

    Examples
    --------
    >>> from satisfice import collision
    >>> step = collision.Step()
    >>> faces = [[0, 1, 2]]
    >>> floor = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]
    >>> high, low = [[[x, y, z] for x, y in [(1, 1), (2, 1), (1, 2)]] for z in (3.0, -1.0)]
    >>> step.add(floor, floor, faces), step.add(high, low, faces)
    (0, 1)
    >>> round(step.free_step(), 3)
    0.75
    """

    def __init__(self) -> None:
        self._step = _satisfice.Step()

    def add(self, start: Any, end: Any, faces: Any = None, *, self_collision: bool = False) -> int:
        """Add a body.

        Parameters
        ----------
        start, end : array, shape (n, 3)
            Its vertices at time 0 and at time 1. Without `faces`, `start` is a mesh (see `mesh`).
        faces : array of int, shape (m, 3), optional
            Its triangles.
        self_collision : bool, default False
            Whether it also collides with itself, features that share a vertex excepted.

        Returns
        -------
        int
            Its number.
        """
        return self._step.add(mesh(start, faces), vertices_of(end), bool(self_collision))

    def set_motion(self, body: int, start: Any, end: Any) -> None:
        """Give a body another motion: the next step of a simulation. Its trees are kept and fitted to it, which takes a fraction of
        the time of a step made anew; answers are the same.

        Parameters
        ----------
        body : int
            Its number.
        start, end : array, shape (n, 3)
            Its vertices at time 0 and at time 1.
        """
        self._step.set_motion(whole("body", body, least=0), vertices_of(start), vertices_of(end))

    def impacts(
        self,
        *,
        threshold: float = 0.0,
        pairs: str | None = None,
        tolerance: float = 1e-6,
        time: float | None = None,
        threads: int = 1,
    ) -> Impacts:
        """All pairs that come nearer than a threshold, or touch for a threshold of 0, at some time of the step.

        Parameters
        ----------
        threshold : float, default 0
            In the unit of the vertices.
        pairs : str, optional
            ``"vertex-vertex"``, ``"vertex-edge"``, ``"vertex-triangle"`` or ``"edge-edge"``. By default the last two, in one of which
            surfaces first meet, and the others, too, if a vertex belongs to no triangle.
        tolerance : float, default 1e-6
            The greatest distance of the two bounds of a time, at least 1e-12.
        time : float, optional
            Stop after so many seconds, with what was found.
        threads : int, default 1
            Threads, 0 for one per core, at most 1,024. They do not change the impacts.
        """
        (body_a, body_b, a, b), times, (point_a, point_b, normal), counts, complete = self._step.impacts(
            pairs, real("threshold", threshold), real("tolerance", tolerance), seconds(time), whole("threads", threads, least=0)
        )
        names = np.array([name for name, _ in counts], dtype=np.str_)
        kind = np.repeat(names, np.array([count for _, count in counts], dtype=np.intp))
        return Impacts(body_a, body_b, a, b, np.column_stack(times), point_a, point_b, normal, kind, complete)

    def free_step(self, *, threshold: float = 0.0, time: float | None = None) -> float:
        """A time up to which the step is proved free of impacts; 1 if the whole step is. After `time` seconds it is what is
        proved until then: the step is free up to it, and may be for longer.

        An impact is a vertex that meets a triangle, or an edge that meets an edge. Surfaces that do not intersect at the start do not
        before the first impact. Those that intersect at the start may go on to do so without one: see that they do not, by
        ``any_closer(a, b, threshold=1e-12, pairs="triangle-triangle")``, or of one mesh by ``close_pairs`` in the same
        way, which leaves out triangles that share a vertex."""
        return self._step.free_step(real("threshold", threshold), seconds(time))

    def earliest(
        self, *, threshold: float = 0.0, tolerance: float = 1e-6, time: float | None = None
    ) -> tuple[tuple[float, float], tuple[str, tuple[int, int, int, int]] | None, bool]:
        """The first impact: bounds of its time, the kind and the pair (body_a, body_b, a, b), whether that is proved."""
        (lower, upper), first, proved = self._step.earliest(
            real("threshold", threshold), real("tolerance", tolerance), seconds(time)
        )
        if first is None:
            return (lower, upper), None, proved
        kind, (body_a, body_b, a, b) = first
        return (lower, upper), (kind, (body_a, body_b, a, b)), proved


def impacts(
    start: Any,
    end: Any,
    faces: Any = None,
    *,
    threshold: float = 0.0,
    pairs: str | None = None,
    tolerance: float = 1e-6,
    time: float | None = None,
    threads: int = 1,
) -> Impacts:
    """The impacts of one mesh with itself during a step; several bodies go into a `Step`.

    Parameters
    ----------
    start, end : array, shape (n, 3)
        Its vertices at time 0 and at time 1. Without `faces`, `start` is a mesh (see `mesh`).
    faces : array of int, shape (m, 3), optional
        Its triangles.
    threshold, pairs, tolerance, time, threads
        As for `Step.impacts`.
    """
    step = Step()
    step.add(start, end, faces, self_collision=True)
    return step.impacts(threshold=threshold, pairs=pairs, tolerance=tolerance, time=time, threads=threads)


def free_step(
    start: Any, end: Any, faces: Any = None, *, threshold: float = 0.0, time: float | None = None
) -> float:
    """The part of a step, from 0 to 1, that a mesh can move without an impact with itself; several bodies go into a `Step`.

    It is proved: up to that time no vertex touches a triangle, and no edge an edge (for a threshold: comes nearer than it). That the mesh
    does not intersect itself at the start is for you to see, as for `Step.free_step`. After `time` seconds it is what is proved until
    then.
    """
    step = Step()
    step.add(start, end, faces, self_collision=True)
    return step.free_step(threshold=threshold, time=time)
