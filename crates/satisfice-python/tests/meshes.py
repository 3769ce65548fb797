"""Meshes that several tests use."""

import numpy as np


def sheet(n, height=0.0, seed=0, noise=0.0):
    """A square of n x n vertices with triangles, its height disturbed."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    z = height + noise * rng.standard_normal((n, n))
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate(
        [np.stack([corner, corner + n, corner + 1], 1), np.stack([corner + 1, corner + n, corner + n + 1], 1)]
    )
    return vertices, faces


# Two sheets above each other.
A, B = sheet(9, 0.0, seed=1, noise=0.01), sheet(8, 0.1, seed=2, noise=0.01)
