"""Bodies that move from frame to frame."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _satisfice
from .._checked import real, seconds, whole, whole_or_none
from .._satisfice import Body
from ._mesh import mesh as mesh_of
from ._mesh import point_of, pose_of, vertices_of

_CONTACT = np.dtype([("body_a", "u4"), ("body_b", "u4"), ("a", "u4"), ("b", "u4"), ("distance", "f8")])


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
        Threads of the queries, 0 for one per core, at most 1,024.

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
        self._world = _satisfice.World(pairs, real("threshold", threshold), whole("threads", threads, least=0))

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
        self._world.set_threshold(real("threshold", value))

    def add(
        self,
        mesh: Any,
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
        mesh : mesh
            Its mesh (see `collision.mesh`). Bodies of one `Mesh` share it.
        motion : {"rigid", "fixed", "deforming"}
            How it may move: by `place` and `translate`, not at all, or by `deform`. Only a deforming body collides with itself.
        transform : array, shape (4, 4) or (3,), optional
            Where it is first; a deforming body is where its vertices are.
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
        if motion == "deforming" and transform is not None:
            raise ValueError("transform does not apply to a deforming body: it is where its vertices are")
        return self._world.add(
            mesh_of(mesh), motion, pose_of(transform), _bits(groups, mask), bool(self_collision), whole("ring", ring, least=0)
        )

    def place(self, body: Body, transform: ArrayLike | None) -> None:
        """Move a rigid body to this rotation and translation, shape (4, 4), or translation, shape (3,)."""
        self._world.place(body, pose_of(transform))

    def translate(self, body: Body, translation: ArrayLike) -> None:
        """Move a rigid body to this translation, shape (3,). It stays turned as it is, unlike by `place` with a translation."""
        self._world.translate(body, point_of("translation", translation))

    def deform(self, body: Body, vertices: ArrayLike) -> None:
        """Move the vertices of a deforming body, shape (n, 3)."""
        self._world.deform(body, vertices_of(vertices))

    def remove(self, body: Body) -> None:
        """Remove a body. Its handle is refused from now on."""
        self._world.remove(body)

    def replace(self, body: Body, mesh: Any) -> None:
        """Give a body another mesh."""
        self._world.replace(body, mesh_of(mesh))

    def set_groups(self, body: Body, groups: int, mask: int = 0xFFFFFFFF) -> None:
        """Set the groups of a body and the groups that it collides with."""
        self._world.set_groups(body, *_bits(groups, mask))

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
        complete, recomputed, skipped = self._world.update(seconds(time), whole_or_none("limit", limit))
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
        found, complete = self._world.touching(seconds(time))
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
        contact, complete = self._world.first(seconds(time))
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
        (columns, distances, _, _), complete = self._world.nearest(whole("count", count, least=0), seconds(time))
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
        found = self._world.nearest_to_point(point_of("point", point))
        return None if found is None else (*found[:3], np.array(found[3]))

    def cast_ray(self, start: ArrayLike, end: ArrayLike) -> tuple[Body, int, float, NDArray[np.float64]] | None:
        """What a ray from `start` to `end`, each of shape (3,), meets first: body, triangle, the share of the way, the point."""
        found = self._world.cast_ray(point_of("start", start), point_of("end", end))
        return None if found is None else (*found[:3], np.array(found[3]))

    def bodies_in(self, lower: ArrayLike, upper: ArrayLike) -> list[Body]:
        """The bodies whose boxes meet the box from `lower` to `upper`, each of shape (3,)."""
        return self._world.bodies_in(point_of("lower", lower), point_of("upper", upper))


def _bits(groups: int, mask: int) -> tuple[int, int]:
    return whole("groups", groups, 0, 2**32 - 1), whole("mask", mask, 0, 2**32 - 1)


def _contacts(columns: Sequence[Any], distances: Any) -> NDArray[np.void]:
    contacts = np.empty(len(columns[0]), _CONTACT)
    for name, column in zip(("body_a", "body_b", "a", "b"), columns, strict=True):
        contacts[name] = column
    contacts["distance"] = distances
    return contacts
