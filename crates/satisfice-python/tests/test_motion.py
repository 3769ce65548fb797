"""Bodies that move during a step."""

import numpy as np
import pytest
from meshes import A, B, sheet
from satisfice import collision


def test_a_step_without_bodies_has_no_impacts():
    found = collision.Step().impacts()
    assert len(found) == 0 and found.complete and found.kind.shape == (0,)


def test_impacts_of_a_falling_sheet():
    low, high = A, (B[0] + [0, 0, 1.0], B[1])
    step = collision.Step()
    step.add(*low[:1], low[0], low[1])
    step.add(high[0], high[0] - [0, 0, 2.0], high[1])
    both = step.impacts(tolerance=1e-9)
    found = step.impacts(tolerance=1e-9, pairs="vertex-triangle")
    assert found.complete and len(found) > 50
    assert (found.time[:, 0] <= found.time[:, 1]).all() and (np.diff(found.time, axis=1) <= 1e-9).all()
    # Vertices of the upper sheet against triangles of the lower one, referee: where the line meets the plane.
    upper = found.body_a == 1
    start = high[0][found.a[upper]]
    corners = low[0][low[1][found.b[upper]]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    height = np.einsum("ij,ij->i", start - corners[:, 0], normal) / normal[:, 2]
    np.testing.assert_allclose(found.time[upper].mean(axis=1), height / 2.0, atol=1e-8)
    edges = step.impacts(pairs="edge-edge", threads=2)
    assert list(both.kind) == ["vertex-triangle"] * len(found) + ["edge-edge"] * len(edges) and len(edges) > 0 and both.complete
    np.testing.assert_array_equal(both.a, np.concatenate([found.a, edges.a]))
    np.testing.assert_array_equal(found.kind, ["vertex-triangle"] * len(found))
    first = min(found.time[:, 0].min(), edges.time[:, 0].min())
    assert step.free_step() == pytest.approx(first, abs=2e-6) and 0 < step.free_step() <= first + 1e-12
    (lower, upper_bound), pair, proved = step.earliest()
    assert proved and lower <= first + 1e-9 and upper_bound >= first - 1e-9 and pair[0] in ("vertex-triangle", "edge-edge")


def test_a_step_that_moves_on():
    low, high = A, (B[0] + [0, 0, 1.0], B[1])
    kept = collision.Step()
    kept.add(*low[:1], low[0], low[1])
    kept.add(high[0], high[0], high[1])
    assert kept.free_step() == 1.0
    for start, end in [(1.0, 0.5), (0.5, -1.0), (-1.0, 1.0)]:
        ends = [B[0] + [0, 0, z] for z in (start, end)]
        kept.set_motion(1, *ends)
        anew = collision.Step()
        anew.add(*low[:1], low[0], low[1])
        anew.add(*ends, high[1])
        assert kept.free_step() == pytest.approx(anew.free_step(), abs=2e-6)
        columns = [(found.a, found.b, found.time, found.point_a) for found in (kept.impacts(), anew.impacts())]
        for one, other in zip(*columns):
            np.testing.assert_array_equal(one, other)
    with pytest.raises(ValueError, match="body"):
        kept.set_motion(2, *ends)
    with pytest.raises(ValueError, match="vertices at the end"):
        kept.set_motion(1, ends[0], ends[1][1:])


def test_a_sheet_that_folds_onto_itself():
    vertices, faces = sheet(7)
    folded = vertices.copy()
    folded[vertices[:, 0] > 0.5, 0] = 1.0 - folded[vertices[:, 0] > 0.5, 0]
    folded[vertices[:, 0] > 0.5, 2] = -0.3
    free = collision.free_step(vertices + [0, 0, 0.1] * (vertices[:, :1] > 0.5), folded, faces)
    assert 0 < free < 1
    assert len(collision.impacts(vertices, vertices, faces)) == 0 and collision.free_step(vertices, vertices, faces) == 1.0
    with pytest.raises(ValueError, match="edge-edge"):
        collision.impacts(vertices, folded, faces, pairs="triangle-triangle")
    with pytest.raises(ValueError, match="as many"):
        collision.impacts(vertices, folded[1:], faces)
