"""Close pairs and the distance of two meshes, or of a mesh with itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _satisfice
from .._checked import real, seconds, whole, whole_or_none
from ._mesh import mesh, pose_of
from ._world import Nearest, World


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
        Threads, 0 for one per core, at most 1,024. They do not change the pairs.

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
        real("threshold", threshold),
        (pose_of(transform_a), pose_of(transform_b)),
        whole("ring", ring, least=0),
        bool(witnesses),
        seconds(time),
        whole_or_none("limit", limit),
        whole("threads", threads, least=0),
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
