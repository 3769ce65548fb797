"""Meshes, points and transforms, checked, as the native part takes them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._checked import reals
from .._satisfice import Mesh


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
        elif isinstance(value, list) and len(value) == 2 and np.ndim(value[0]) == 2:
            raise ValueError("a mesh of vertices and faces is a tuple (V, F), not a list of both")
    return Mesh(vertices_of(vertices), indices_of("faces", faces, 3), indices_of("edges", edges, 2))


def vertices_of(value: Any) -> NDArray[np.float64]:
    if isinstance(value, (str, bytes)):
        raise ValueError(f"no mesh: {value!r} is text; read a file first, for example by trimesh.load(path)")
    if not hasattr(value, "__len__"):
        raise ValueError(f"no mesh: {type(value).__name__} has no vertices and faces, and is no array of shape (n, 3)")
    array = reals("vertices", value)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"vertices have shape {array.shape}: they need shape (n, 3)")
    return array


def indices_of(name: str, value: Any, corners: int) -> NDArray[np.int64] | None:
    if value is None:
        return None
    if np.ma.is_masked(value):
        raise ValueError(f"{name} must have no masked entries: leave them out, or fill them")
    array = np.asarray(value)
    if array.size == 0:
        return np.empty((0, corners), np.int64)
    if array.ndim != 2 or array.shape[1] != corners:
        raise ValueError(f"{name} have shape {array.shape}: they need shape (m, {corners})")
    if array.dtype.kind not in "iu":
        raise ValueError(f"{name} are of type {array.dtype}: they need whole numbers")
    return np.ascontiguousarray(array, dtype=np.int64)


def pose_of(transform: Any) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
    """A rotation, as a quaternion, and a translation."""
    if transform is None:
        return None
    array = reals("a transform", transform)
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


def point_of(name: str, value: ArrayLike) -> tuple[float, ...]:
    array = reals(name, value)
    if array.shape != (3,):
        raise ValueError(f"{name} has shape {array.shape}: a point needs shape (3,)")
    return tuple(array.tolist())
