"""Mesh collision: close pairs, worlds of moving bodies, impacts during a step. Exact.

Anything with ``vertices`` (n, 3) and ``faces`` (m, 3) is a mesh (a `trimesh.Trimesh` is one), and so is a tuple ``(V, F)``.

>>> import numpy as np
>>> from satisfice import collision
>>> triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
>>> floor = (triangle, [[0, 1, 2]])
>>> above = (np.array(triangle) + [0, 0, 0.25], [[0, 1, 2]])
>>> pairs = collision.close_pairs(floor, above, threshold=0.5)
>>> pairs.i, pairs.j, pairs.distance
(array([0], dtype=uint32), array([0], dtype=uint32), array([0.25]))

The coordinates as they are given define the question, and whether a distance is below the threshold is decided without error.
The threshold is strict: distance < threshold. (SciPy's `cKDTree` has ``<=``.) Ctrl-C ends every query that takes long.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _satisfice
from ._satisfice import Body, Mesh

__all__ = [
    "Body",
    "Impacts",
    "Mesh",
    "Nearest",
    "Pairs",
    "Step",
    "Update",
    "World",
    "any_closer",
    "close_pairs",
    "distance",
    "free_step",
    "impacts",
    "mesh",
]

_CONTACT = np.dtype([("body_a", "u4"), ("body_b", "u4"), ("a", "u4"), ("b", "u4"), ("distance", "f8")])


def mesh(value: Any, faces: Any = None, edges: Any = None) -> Mesh:
    """A mesh, checked once and usable in any number of queries, which then share its search trees.

    Parameters
    ----------
    value : Mesh, object with ``vertices`` and ``faces``, tuple (V, F), or array of shape (n, 3)
        The mesh; an array alone is its vertices, in the unit of your choice.
    faces : array of int, shape (m, 3), optional
        Triangles by their vertices.
    edges : array of int, shape (k, 2), optional
        Edges that are not sides of triangles.

    Returns
    -------
    Mesh

    Raises
    ------
    ValueError
        For coordinates that are not finite, indices out of range, or arrays of another shape.
    """
    if isinstance(value, Mesh):
        if faces is not None or edges is not None:
            raise ValueError("a Mesh has its faces and edges already")
        return value
    vertices = value
    if faces is None and edges is None:
        if hasattr(value, "vertices") and hasattr(value, "faces"):
            vertices, faces = value.vertices, value.faces
        elif isinstance(value, tuple) and len(value) == 2:
            vertices, faces = value
    return Mesh(_vertices(vertices), _indices("faces", faces, 3), _indices("edges", edges, 2))


def _vertices(value: Any) -> NDArray[np.float64]:
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"no mesh: {type(value).__name__} has no vertices and faces, and is no array of shape (n, 3)") from None
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"vertices have shape {array.shape}: they need shape (n, 3)")
    return np.ascontiguousarray(array)


def _indices(name: str, value: Any, corners: int) -> NDArray[np.int64] | None:
    if value is None:
        return None
    array = np.asarray(value)
    if array.size == 0:
        return np.empty((0, corners), np.int64)
    if array.ndim != 2 or array.shape[1] != corners:
        raise ValueError(f"{name} have shape {array.shape}: they need shape (m, {corners})")
    if array.dtype.kind not in "iu":
        raise ValueError(f"{name} are of type {array.dtype}: they need whole numbers")
    return np.ascontiguousarray(array, dtype=np.int64)


def _pose(transform: Any) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
    """A rotation, as a quaternion, and a translation."""
    if transform is None:
        return None
    array = np.asarray(transform, dtype=np.float64)
    if array.shape == (3,):
        return (1.0, 0.0, 0.0, 0.0), tuple(array.tolist())
    if array.shape != (4, 4):
        raise ValueError(f"a transform has shape {array.shape}: it needs shape (4, 4), or (3,) for a translation")
    rotation = array[:3, :3]
    is_rigid = np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-6) and np.linalg.det(rotation) > 0
    if not is_rigid or not np.array_equal(array[3], [0, 0, 0, 1]):
        raise ValueError("a transform must be a rotation and a translation; scale and shear the vertices instead")
    return _quaternion(rotation), tuple(array[:3, 3].tolist())


def _quaternion(r: NDArray[np.float64]) -> tuple[float, ...]:
    """(w, x, y, z), by its greatest component (Shepperd 1978)."""
    (a, b, c), (d, e, f), (g, h, i) = r.tolist()
    w2, x2, y2, z2 = 1 + a + e + i, 1 + a - e - i, 1 - a + e - i, 1 - a - e + i
    greatest = max(w2, x2, y2, z2)
    if greatest == w2:
        q = (w2, h - f, c - g, d - b)
    elif greatest == x2:
        q = (h - f, x2, b + d, c + g)
    elif greatest == y2:
        q = (c - g, b + d, y2, f + h)
    else:
        q = (d - b, c + g, f + h, z2)
    length = math.hypot(*q)
    return tuple(part / length for part in q)


@dataclass(frozen=True, eq=False)
class Pairs:
    """Close pairs of features, sorted by `i`, then by `j`.

    Attributes
    ----------
    i, j : ndarray of uint32, shape (m,)
        Numbers of the features in the first and in the second mesh. Edges are numbered in the order of their ends
        ``(a, b)``, a < b.
    distance : ndarray of float64, shape (m,)
        Their distances, within one unit in the last place.
    point_a, point_b : ndarray of float64, shape (m, 3), or None
        Closest points, if witnesses were asked for.
    complete : bool
        Whether these are all pairs: neither the time nor the limit has ended the query.
    """

    i: NDArray[np.uint32]
    j: NDArray[np.uint32]
    distance: NDArray[np.float64]
    point_a: NDArray[np.float64] | None
    point_b: NDArray[np.float64] | None
    complete: bool

    def __len__(self) -> int:
        return len(self.i)

    def to_coo(self, shape: tuple[int, int]) -> Any:
        """The distances as a sparse matrix (`scipy.sparse.coo_array`) of this shape. A distance of 0 is stored, too."""
        from scipy.sparse import coo_array  # type: ignore[import-untyped, unused-ignore]

        return coo_array((self.distance, (self.i, self.j)), shape=shape)


def close_pairs(
    a: Any,
    b: Any = None,
    *,
    threshold: float,
    pairs: str = "triangle-triangle",
    transform_a: ArrayLike | None = None,
    transform_b: ArrayLike | None = None,
    ring: int = 0,
    witnesses: bool = False,
    time: float | None = None,
    limit: int | None = None,
    threads: int = 1,
) -> Pairs:
    """All pairs of features of two meshes, or of one, that are closer than a threshold.

    Parameters
    ----------
    a, b : mesh
        The meshes (see `mesh`). Without `b`: the pairs of `a` with itself.
    threshold : float
        A pair is close if its distance is below it, strictly. Positive, in the unit of the vertices.
    pairs : str, default "triangle-triangle"
        ``"vertex-vertex"``, ``"vertex-edge"``, ``"vertex-triangle"``, ``"edge-edge"``, ``"edge-triangle"`` or
        ``"triangle-triangle"``: features of `a`, features of `b`.
    transform_a, transform_b : array, shape (4, 4) or (3,), optional
        Where the meshes are: a rotation and a translation, or a translation. The rotation is rounded to a unit quaternion.
    ring : int, default 0
        Without `b`: leave out pairs with vertices within so many edges of each other. 0 leaves out features that share a
        vertex.
    witnesses : bool, default False
        Also return closest points.
    time : float, optional
        Stop after so many seconds, with what was found.
    limit : int, optional
        Stop at so many pairs.
    threads : int, default 1
        Threads, 0 for one per core. They do not change the pairs.

    Returns
    -------
    Pairs

    Raises
    ------
    ValueError
        For a mesh, a threshold or a kind that is not usable.
    """
    if b is None and (transform_a is not None or transform_b is not None):
        raise ValueError("a transform does not change the pairs of a mesh with itself: leave it out")
    if b is not None and ring != 0:
        raise ValueError("ring applies to the pairs of a mesh with itself")
    i, j, distance, points, complete = _satisfice.close_pairs(
        mesh(a),
        None if b is None else mesh(b),
        pairs,
        float(threshold),
        (_pose(transform_a), _pose(transform_b)),
        ring,
        witnesses,
        time,
        limit,
        threads,
    )
    point_a, point_b = points if points is not None else (None, None)
    return Pairs(i, j, distance, point_a, point_b, complete)


def any_closer(
    a: Any,
    b: Any = None,
    *,
    threshold: float,
    pairs: str = "triangle-triangle",
    transform_a: ArrayLike | None = None,
    transform_b: ArrayLike | None = None,
    ring: int = 0,
) -> bool:
    """Whether any two features are closer than a threshold. Stops at the first pair.

    The parameters are those of `close_pairs`; features of either mesh count in both orders.
    """
    world = World(threshold=threshold, pairs=pairs)
    if b is None:
        if transform_a is not None or transform_b is not None:
            raise ValueError("a transform does not change the pairs of a mesh with itself: leave it out")
        world.add(a, "deforming", ring=ring)
    else:
        world.add(a, transform=transform_a)
        world.add(b, transform=transform_b)
    return world.first() is not None


class Nearest(NamedTuple):
    """Two features and their distance.

    Attributes
    ----------
    distance : float
        Their distance, within one unit in the last place; 0 if they meet.
    a, b : int
        Their numbers in the meshes of the bodies.
    point_a, point_b : ndarray, shape (3,)
        Closest points.
    """

    distance: float
    a: int
    b: int
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]


def distance(
    a: Any,
    b: Any,
    *,
    pairs: str = "triangle-triangle",
    transform_a: ArrayLike | None = None,
    transform_b: ArrayLike | None = None,
) -> Nearest:
    """The distance of two meshes, and where they are closest.

    The parameters are those of `close_pairs`.

    Raises
    ------
    ValueError
        If a mesh has no such features.
    """
    world = World(threshold=1.0, pairs=pairs)
    nearest = world.distance(world.add(a, transform=transform_a), world.add(b, transform=transform_b))
    if nearest is None:
        raise ValueError(f"a mesh has no features for {pairs}")
    return nearest


@dataclass(frozen=True)
class Update:
    """What `World.update` did.

    Attributes
    ----------
    complete : bool
        Whether all contacts are known.
    recomputed : int
        Pairs of bodies, or bodies with themselves, that were looked at.
    skipped : dict of str to int
        What was skipped, by reason.
    """

    complete: bool
    recomputed: int
    skipped: dict[str, int]


class World:
    """Bodies that move from frame to frame, and which of their features are close. A frame costs what moved in it.

    Parameters
    ----------
    threshold : float
        Two features are a contact if their distance is below it, strictly.
    pairs : str, default "triangle-triangle"
        The kind of pair, as for `close_pairs`. For two different features, both orders of the bodies count.
    threads : int, default 1
        Threads of the queries, 0 for one per core.

    Examples
    --------
    >>> from satisfice import collision
    >>> triangle = ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> world = collision.World(threshold=0.1)
    >>> floor = world.add(triangle, "fixed")
    >>> lid = world.add(triangle, transform=[0, 0, 1])
    >>> world.update().complete, len(world.contacts())
    (True, 0)
    >>> world.place(lid, [0, 0, 0.05])
    >>> world.update().recomputed, world.contacts()["distance"]
    (1, array([0.05]))
    """

    def __init__(self, *, threshold: float, pairs: str = "triangle-triangle", threads: int = 1) -> None:
        self._world = _satisfice.World(pairs, float(threshold), threads)

    def __len__(self) -> int:
        return len(self._world)

    def __iter__(self) -> Iterator[Body]:
        return iter(self._world.bodies())

    @property
    def threshold(self) -> float:
        """A contact is closer than this. Setting it takes effect at the next query."""
        return self._world.threshold()

    @threshold.setter
    def threshold(self, value: float) -> None:
        self._world.set_threshold(float(value))

    def add(
        self,
        mesh_: Any,
        motion: str = "rigid",
        *,
        transform: ArrayLike | None = None,
        groups: int = 1,
        mask: int = 0xFFFFFFFF,
        self_collision: bool = True,
        ring: int = 0,
    ) -> Body:
        """Add a body.

        Parameters
        ----------
        mesh_ : mesh
            Its mesh (see `mesh`). Bodies of one `Mesh` share it.
        motion : {"rigid", "fixed", "deforming"}
            How it may move: by `place`, not at all, or by `deform`. Only a deforming body collides with itself.
        transform : array, shape (4, 4) or (3,), optional
            Where it is first, unless it deforms.
        groups, mask : int
            Two bodies collide if the mask of each has a bit of the other's groups; 32 bits.
        self_collision : bool
            Whether a deforming body collides with itself.
        ring : int
            Leave out pairs of a deforming body with vertices within so many edges of each other.

        Returns
        -------
        Body
            Its handle, valid until it is removed.
        """
        return self._world.add(mesh(mesh_), motion, _pose(transform), (groups, mask), self_collision, ring)

    def place(self, body: Body, transform: ArrayLike | None) -> None:
        """Move a rigid body to this rotation and translation, shape (4, 4), or translation, shape (3,)."""
        self._world.place(body, _pose(transform))

    def deform(self, body: Body, vertices: ArrayLike) -> None:
        """Move the vertices of a deforming body, shape (n, 3)."""
        self._world.deform(body, _vertices(vertices))

    def remove(self, body: Body) -> None:
        """Remove a body. Its handle is refused from now on."""
        self._world.remove(body)

    def replace(self, body: Body, mesh_: Any) -> None:
        """Give a body another mesh."""
        self._world.replace(body, mesh(mesh_))

    def set_groups(self, body: Body, groups: int, mask: int = 0xFFFFFFFF) -> None:
        """Set the groups of a body and the groups that it collides with."""
        self._world.set_groups(body, groups, mask)

    def exclude(self, a: Body, b: Body) -> None:
        """Let two bodies not collide."""
        self._world.exclude(a, b)

    def include(self, a: Body, b: Body) -> None:
        """Take an exclusion back."""
        self._world.include(a, b)

    def update(self, *, time: float | None = None, limit: int | None = None) -> Update:
        """Bring the contacts up to date with what was added, removed and moved.

        Parameters
        ----------
        time : float, optional
            Stop after so many seconds; the next update goes on.
        limit : int, optional
            Stop at about so many contacts.
        """
        complete, recomputed, skipped = self._world.update(time, limit)
        return Update(complete, recomputed, dict(skipped))

    def contacts(self, *, distances: bool = True) -> NDArray[np.void]:
        """The contacts as of the last update, sorted by bodies, then by features.

        Parameters
        ----------
        distances : bool, default True
            Whether to measure them; otherwise ``distance`` is NaN.

        Returns
        -------
        ndarray, shape (m,)
            With the fields ``body_a``, ``body_b`` (`Body.index`), ``a``, ``b`` (features, uint32) and ``distance``.
        """
        columns, measured = self._world.contacts(distances)
        return _contacts(columns, math.nan if measured is None else measured)

    def changes(self) -> dict[str, NDArray[np.void]]:
        """The contacts that the last update has looked at: ``"begun"``, ``"persisting"`` and ``"ended"``."""
        columns, kinds = self._world.changes()
        contacts = _contacts(columns, math.nan)
        names = np.array(kinds, dtype="U10")
        return {kind: contacts[names == kind] for kind in ("begun", "persisting", "ended")}

    def touching(self, *, time: float | None = None) -> list[tuple[Body, Body]]:
        """Pairs of bodies with a contact, found at the first contact of each.

        Raises
        ------
        TimeoutError
            If the time, in seconds, has ended before all are known.
        """
        found, complete = self._world.touching(time)
        if not complete:
            raise TimeoutError(f"{len(found)} pairs of bodies were found in time, and there may be more")
        return found

    def first(self, *, time: float | None = None) -> tuple[int, int, int, int] | None:
        """Some contact (body_a, body_b, a, b), by `Body.index`; ``None`` if there is none.

        Raises
        ------
        TimeoutError
            If the time, in seconds, has ended before that is known.
        """
        contact, complete = self._world.first(time)
        if contact is None and not complete:
            raise TimeoutError("no contact was found in time, and there may be one")
        return contact

    def nearest(self, count: int = 1, *, time: float | None = None) -> NDArray[np.void]:
        """The closest pairs of features at any distance, closest first, as `contacts` has them.

        Raises
        ------
        TimeoutError
            If the time, in seconds, has ended before they are known.
        """
        (columns, distances, _, _), complete = self._world.nearest(count, time)
        if not complete:
            raise TimeoutError("the closest pairs were not known in time")
        return _contacts(columns, distances)

    def distance(self, a: Body, b: Body) -> Nearest | None:
        """The distance of two bodies, and where they are closest; ``None`` if one has no such features."""
        found = self._world.distance(a, b)
        if found is None:
            return None
        first, _, i, j, value, point_a, point_b = found
        nearest = Nearest(value, i, j, np.array(point_a), np.array(point_b))
        return nearest if first == a.index else Nearest(value, j, i, nearest.point_b, nearest.point_a)

    def nearest_to_point(self, point: ArrayLike) -> tuple[Body, int, float, NDArray[np.float64]] | None:
        """The body closest to a point of shape (3,): body, its feature, the distance, the closest point."""
        found = self._world.nearest_to_point(_point(point))
        return None if found is None else (*found[:3], np.array(found[3]))

    def cast_ray(self, start: ArrayLike, end: ArrayLike) -> tuple[Body, int, float, NDArray[np.float64]] | None:
        """What a ray from `start` to `end`, each of shape (3,), meets first: body, triangle, the share of the way, the point."""
        found = self._world.cast_ray(_point(start), _point(end))
        return None if found is None else (*found[:3], np.array(found[3]))

    def bodies_in(self, lower: ArrayLike, upper: ArrayLike) -> list[Body]:
        """The bodies whose boxes meet the box from `lower` to `upper`, each of shape (3,)."""
        return self._world.bodies_in(_point(lower), _point(upper))


def _contacts(columns: Sequence[Any], distances: Any) -> NDArray[np.void]:
    contacts = np.empty(len(columns[0]), _CONTACT)
    for name, column in zip(("body_a", "body_b", "a", "b"), columns, strict=True):
        contacts[name] = column
    contacts["distance"] = distances
    return contacts


def _point(value: ArrayLike) -> tuple[float, ...]:
    array = np.asarray(value, dtype=np.float64)
    if array.shape != (3,):
        raise ValueError(f"a point has shape {array.shape}: it needs shape (3,)")
    return tuple(array.tolist())


@dataclass(frozen=True, eq=False)
class Impacts:
    """Pairs of features that come near each other during a step, in ascending order.

    Attributes
    ----------
    body_a, body_b, a, b : ndarray of uint32, shape (m,)
        Bodies in the order of adding, and features of their meshes.
    time : ndarray of float64, shape (m, 2)
        A lower and an upper bound of the time of impact, both proved; 0 is the start of the step and 1 its end.
    point_a, point_b, normal : ndarray of float64, shape (m, 3)
        Closest points at the upper bound, and a unit vector from the second feature towards the first at about that time (0
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
        return self._step.add(mesh(start, faces), _vertices(end), self_collision)

    def impacts(
        self,
        *,
        threshold: float = 0.0,
        pairs: str = "vertex-triangle",
        tolerance: float = 1e-6,
        time: float | None = None,
        threads: int = 1,
    ) -> Impacts:
        """All pairs that come nearer than a threshold, or touch for a threshold of 0, at some time of the step.

        Parameters
        ----------
        threshold : float, default 0
            In the unit of the vertices.
        pairs : str, default "vertex-triangle"
            ``"vertex-vertex"``, ``"vertex-edge"``, ``"vertex-triangle"`` or ``"edge-edge"``. Surfaces that meet do so in a pair
            of one of the last two kinds.
        tolerance : float, default 1e-6
            The greatest distance of the two bounds of a time, at least 1e-12.
        time : float, optional
            Stop after so many seconds, with what was found.
        threads : int, default 1
            Threads, 0 for one per core. They do not change the impacts.
        """
        (body_a, body_b, a, b), times, (point_a, point_b, normal), complete = self._step.impacts(
            pairs, float(threshold), float(tolerance), time, threads
        )
        return Impacts(body_a, body_b, a, b, np.column_stack(times), point_a, point_b, normal, complete)

    def free_step(self, *, threshold: float = 0.0, time: float | None = None) -> float:
        """A time up to which the step is proved free of impacts; 1 if the whole step is. After `time` seconds it is what is
        proved until then: the step is free up to it, and may be for longer."""
        return self._step.free_step(float(threshold), time)

    def earliest(
        self, *, threshold: float = 0.0, tolerance: float = 1e-6, time: float | None = None
    ) -> tuple[tuple[float, float], tuple[str, tuple[int, int, int, int]] | None, bool]:
        """The first impact: bounds of its time, the kind and the pair (body_a, body_b, a, b), whether that is proved."""
        (lower, upper), first, proved = self._step.earliest(float(threshold), float(tolerance), time)
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
    pairs: str = "vertex-triangle",
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

    It is proved: up to that time no two features touch (for a threshold: come nearer than it). After `time` seconds it is what
    is proved until then.
    """
    step = Step()
    step.add(start, end, faces, self_collision=True)
    return step.free_step(threshold=threshold, time=time)
