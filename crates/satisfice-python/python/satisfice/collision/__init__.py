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

from .._satisfice import Body, Mesh
from ._mesh import mesh
from ._motion import Impacts, Step, free_step, impacts
from ._pairs import Pairs, any_closer, close_pairs, distance
from ._world import Nearest, Update, World

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
