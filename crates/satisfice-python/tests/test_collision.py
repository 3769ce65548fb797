"""Meshes, close pairs and worlds, against brute force in NumPy."""

import itertools
import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest
from meshes import A, B, sheet
from satisfice import collision


def point_triangle(p, t):
    """Distance of points (n, 3) and triangles (n, 3, 3), by the seven regions."""
    a, b, c = t[:, 0], t[:, 1], t[:, 2]
    normal = np.cross(b - a, c - a)
    inside = np.ones(len(p), bool)
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(v - u, p - u), normal) >= 0
    plane = np.abs(np.einsum("ij,ij->i", p - a, normal)) / np.linalg.norm(normal, axis=1)
    edges = np.min([point_segment(p, u, v) for u, v in ((a, b), (b, c), (c, a))], axis=0)
    return np.where(inside, plane, edges)


def point_segment(p, u, v):
    share = np.clip(np.einsum("ij,ij->i", p - u, v - u) / np.einsum("ij,ij->i", v - u, v - u), 0, 1)
    return np.linalg.norm(p - u - share[:, None] * (v - u), axis=1)


def segment_segment(a, b, c, d):
    """Distance of segments: the four ends, and the inner point where both are inside."""
    ends = np.min([point_segment(a, c, d), point_segment(b, c, d), point_segment(c, a, b), point_segment(d, a, b)], axis=0)
    u, v, w = b - a, d - c, a - c
    uu, uv, vv = (np.einsum("ij,ij->i", x, y) for x, y in ((u, u), (u, v), (v, v)))
    uw, vw = np.einsum("ij,ij->i", u, w), np.einsum("ij,ij->i", v, w)
    det = uu * vv - uv * uv
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = (uv * vw - vv * uw) / det, (uu * vw - uv * uw) / det
        inner = np.linalg.norm(w + s[:, None] * u - t[:, None] * v, axis=1)
        return np.where((s >= 0) & (s <= 1) & (t >= 0) & (t <= 1) & (det > 1e-14), np.minimum(ends, inner), ends)


def triangle_triangle(s, t):
    """Distance of triangles that do not meet."""
    parts = [point_triangle(s[:, i], t) for i in range(3)] + [point_triangle(t[:, i], s) for i in range(3)]
    for i, j in itertools.product(range(3), repeat=2):
        parts.append(segment_segment(s[:, i], s[:, (i + 1) % 3], t[:, j], t[:, (j + 1) % 3]))
    return np.min(parts, axis=0)


def all_pairs(m, n):
    i, j = np.meshgrid(np.arange(m), np.arange(n), indexing="ij")
    return i.ravel(), j.ravel()



@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize(
    ("pairs", "count", "measure"),
    [
        ("vertex-vertex", (81, 64), lambda i, j: np.linalg.norm(A[0][i] - B[0][j], axis=1)),
        ("vertex-triangle", (81, 98), lambda i, j: point_triangle(A[0][i], B[0][B[1][j]])),
        ("triangle-triangle", (128, 98), lambda i, j: triangle_triangle(A[0][A[1][i]], B[0][B[1][j]])),
    ],
)
def test_close_pairs_agree_with_brute_force(pairs, count, measure, threads):
    i, j = all_pairs(*count)
    expected = measure(i, j)
    threshold = 0.12
    close = expected < threshold
    assert np.abs(expected - threshold).min() > 1e-9
    found = collision.close_pairs(A, B, threshold=threshold, pairs=pairs, threads=threads, witnesses=True)
    assert found.complete and len(found) == close.sum() > 20
    assert np.array_equal(found.i, i[close]) and np.array_equal(found.j, j[close])
    np.testing.assert_allclose(found.distance, expected[close], rtol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(found.point_a - found.point_b, axis=1), found.distance, rtol=1e-9)


def test_the_threshold_is_strict():
    points = [np.zeros((1, 3)), np.array([[3.0, 4.0, 0.0]])]
    assert len(collision.close_pairs(*points, threshold=5.0, pairs="vertex-vertex")) == 0
    assert len(collision.close_pairs(*points, threshold=np.nextafter(5.0, 6.0), pairs="vertex-vertex")) == 1


def test_pairs_of_a_mesh_with_itself():
    vertices, faces = sheet(6)
    vertices[:, 2] = np.where(vertices[:, 0] > 0.5, 0.05, 0.0)
    vertices[:, 0] = np.abs(vertices[:, 0] - 0.5)  # folded
    found = collision.close_pairs((vertices, faces), threshold=0.08, pairs="vertex-vertex", ring=1)
    assert len(collision.close_pairs((vertices, faces), threshold=0.08, pairs="vertex-vertex")) > len(found)
    i, j = np.triu_indices(len(vertices), 1)
    # Vertices that an edge joins are left out.
    edges = {tuple(sorted(edge)) for face in faces for edge in itertools.combinations(face.tolist(), 2)}
    close = np.linalg.norm(vertices[i] - vertices[j], axis=1) < 0.08
    expected = [(a, b) for a, b in zip(i[close].tolist(), j[close].tolist(), strict=True) if (a, b) not in edges]
    assert list(zip(found.i.tolist(), found.j.tolist(), strict=True)) == expected and len(expected) > 5


class Mesh:
    """What trimesh, meshio wrappers and others have in common."""

    def __init__(self, vertices, faces):
        self.vertices, self.faces = vertices, faces


@pytest.mark.parametrize(
    "form",
    [
        lambda v, f: (v, f),
        Mesh,
        lambda v, f: Mesh(np.asfortranarray(v), np.asfortranarray(f.astype(np.int32))),
        lambda v, f: (v.astype(">f8"), f.astype(np.uint64)),
        lambda v, f: (v.tolist(), f.tolist()),
        lambda v, f: (np.repeat(v, 2, axis=0)[::2], f[::-1][::-1]),
        lambda v, f: collision.mesh(v, f),
    ],
)
def test_meshes_of_any_form(form):
    expected = collision.close_pairs(A, B, threshold=0.11)
    for array in A:
        array.setflags(write=False)
    found = collision.close_pairs(form(*A), form(*B), threshold=0.11)
    assert np.array_equal(found.i, expected.i) and np.array_equal(found.distance, expected.distance) and len(found) > 0


def test_transforms_move_the_meshes():
    angle = 2.0
    c, s = np.cos(angle), np.sin(angle)
    rotation = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = rotation, [1, 2, 3]
    moved = [(v @ rotation.T + [1, 2, 3], f) for v, f in (A, B)]
    by_transform = collision.close_pairs(A, moved[1], threshold=0.12, transform_a=transform)
    still = collision.close_pairs(A, B, threshold=0.12)
    assert np.array_equal(by_transform.i, still.i)
    np.testing.assert_allclose(by_transform.distance, still.distance, atol=1e-12)
    for turn in (np.diag([-1.0, -1, 1]), np.diag([-1.0, 1, -1]), np.diag([1.0, -1, -1])):
        half = np.eye(4)
        half[:3, :3] = turn
        found = collision.close_pairs(A, (B[0] @ turn.T, B[1]), threshold=0.12, transform_a=half)
        assert np.array_equal(found.i, still.i)
    shifted = collision.close_pairs(A, (B[0] + [1, 2, 3], B[1]), threshold=0.12, transform_a=[1, 2, 3])
    assert np.array_equal(shifted.i, still.i)


@pytest.mark.parametrize(
    ("arguments", "options", "says"),
    [
        ((A, B), {"threshold": 0.0}, "threshold"),
        ((A, B), {"threshold": float("nan")}, "threshold"),
        ((A, B), {"threshold": 1, "pairs": "vertex-vertx"}, "vertex-vertx"),
        ((3, B), {"threshold": 1}, r"shape \(n, 3\)"),
        (("teapot", B), {"threshold": 1}, "no mesh"),
        ((A[0][:, :2], B), {"threshold": 1}, r"shape \(n, 3\)"),
        (((A[0], A[1][:, :2]), B), {"threshold": 1}, r"shape \(m, 3\)"),
        (((A[0], A[1] * 1.5), B), {"threshold": 1}, "whole numbers"),
        (((A[0], A[1] + 1), B), {"threshold": 1}, "81"),
        (((A[0], A[1] - 1), B), {"threshold": 1}, "vertex -1"),
        (((A[0] * np.nan, A[1]), B), {"threshold": 1}, "NaN"),
        ((np.zeros((0, 3)), B), {"threshold": 1}, "vertices|vertex|empty"),
        ((A, B), {"threshold": 1, "transform_a": np.eye(3)}, r"shape \(4, 4\)"),
        ((A, B), {"threshold": 1, "transform_a": 2 * np.eye(4)}, "rotation"),
        ((A, B), {"threshold": 1, "transform_a": np.diag([-1.0, 1, 1, 1])}, "rotation"),
        ((A,), {"threshold": 1, "transform_a": np.eye(4)}, "itself"),
        ((A, B), {"threshold": 1, "time": -1}, "time"),
    ],
)
def test_bad_input_is_refused(arguments, options, says):
    with pytest.raises(ValueError, match=says):
        collision.close_pairs(*arguments, **options)


def test_a_limit_and_a_time_end_a_query_early():
    fine = sheet(120)
    above = (fine[0] + [0, 0, 0.001], fine[1])
    some = collision.close_pairs(fine, above, threshold=0.02, limit=1000)
    assert not some.complete and len(some) == 1000 and (some.distance < 0.02).all()


def at_last(limit, ask):
    """Whether a query ends within 100 ms of its limit, in processor time of this process: a busy machine takes longer. It has three tries."""
    for _ in range(3):
        spent = []
        timer = threading.Timer(limit, lambda: spent.append(time.process_time()))
        timer.start()
        answer = ask()
        late = time.process_time() - spent[0] if spent else 0.0
        timer.cancel()
        if late < 0.1:
            return answer
    raise AssertionError(f"{late} s of processor time late")


def test_a_deadline_is_kept_with_millions_of_pairs_found():
    mesh = collision.mesh(*sheet(100))
    above = collision.mesh(sheet(100)[0] + [0, 0, 0.001], sheet(100)[1])
    # 4 million pairs
    some = at_last(
        0.3, lambda: collision.close_pairs(mesh, above, threshold=0.12, pairs="vertex-vertex", witnesses=True, time=0.3)
    )
    assert not some.complete and 100 < len(some.i) == len(some.distance) == len(some.point_a)
    assert (some.distance < 0.12).all()


def crumpled(n):
    """A sheet that is moved into itself, so that the descent to its first impact is long."""
    vertices, faces = sheet(n, noise=0.3)
    return vertices, -vertices, faces


def test_a_free_step_can_be_cut_short():
    start, end, faces = crumpled(60)
    step = collision.Step()
    step.add(start, end, faces, self_collision=True)
    cut = at_last(0.02, lambda: step.free_step(threshold=1e-9, time=0.02))
    (_, impact), _, _ = step.earliest(threshold=1e-9, time=0.2)
    assert 0 <= cut <= impact


@pytest.mark.parametrize("query", ["pairs", "step"])
def test_ctrl_c_ends_long_queries_soon(query):
    if query == "pairs":
        mesh = collision.mesh(*sheet(100))
        above = collision.mesh(sheet(100)[0] + [0, 0, 0.001], sheet(100)[1])

        def ask():
            while True:
                collision.close_pairs(mesh, above, threshold=0.1, pairs="vertex-vertex")
    else:
        start, end, faces = crumpled(300)
        step = collision.Step()
        step.add(start, end, faces, self_collision=True)

        def ask():
            while True:
                step.free_step(threshold=1e-9)

    def interrupted():
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            ask()

    at_last(0.3, interrupted)


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_a_query(threads):
    fine = sheet(400)
    mesh, above = collision.mesh(*fine), collision.mesh(fine[0] + [0, 0, 0.001], fine[1])
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        # 10^9 pairs
        collision.close_pairs(mesh, above, threshold=0.5, pairs="vertex-vertex", limit=10**7, threads=threads)
        time.sleep(5)
    assert time.monotonic() - begun < 5


def test_pairs_as_a_sparse_matrix():
    pytest.importorskip("scipy")
    found = collision.close_pairs(A, B, threshold=0.12)
    matrix = found.to_coo((128, 98))
    assert matrix.nnz == len(found) and matrix.toarray()[found.i[0], found.j[0]] == found.distance[0]


def test_pairs_agree_with_the_tree_of_scipy():
    spatial = pytest.importorskip("scipy.spatial")
    rng = np.random.default_rng(3)
    a, b = rng.random((2000, 3)), rng.random((2000, 3))
    found = collision.close_pairs(a, b, threshold=0.05, pairs="vertex-vertex")
    theirs = spatial.cKDTree(a).sparse_distance_matrix(spatial.cKDTree(b), 0.05, output_type="coo_matrix")
    assert set(zip(found.i.tolist(), found.j.tolist(), strict=True)) == set(
        zip(theirs.row.tolist(), theirs.col.tolist(), strict=True)
    )


def test_a_body_that_cannot_move_so_is_named():
    world = collision.World(threshold=0.1)
    world.add(sheet(3), "fixed")
    lid = world.add(sheet(3), "deforming")
    with pytest.raises(ValueError, match="body = 1 is not allowed: it is not rigid"):
        world.place(lid, [0, 0, 1])


def test_a_mesh_can_be_pickled():
    corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 5.0]]
    mesh = collision.mesh(corners, [[0, 1, 2]], [[0, 3]])
    again = pickle.loads(pickle.dumps(mesh))
    assert (again.vertices == mesh.vertices).all() and (again.faces == mesh.faces).all()
    line = collision.mesh([[-1.0, 0.0, 4.0], [1.0, 0.0, 4.0]], edges=[[0, 1]])
    pairs = [collision.close_pairs(one, line, threshold=0.1, pairs="edge-edge") for one in (mesh, again)]
    assert len(pairs[0].i) == 1 and (pairs[1].i == pairs[0].i).all()


def test_a_trimesh_is_a_mesh():
    trimesh = pytest.importorskip("trimesh")
    one, two = trimesh.creation.icosphere(2), trimesh.creation.icosphere(2)
    two.apply_translation([2.5, 0, 0])
    nearest = collision.distance(one, two)
    assert nearest.distance == pytest.approx(0.5, abs=1e-9)
    assert collision.any_closer(one, two, threshold=0.51) and not collision.any_closer(one, two, threshold=0.49)


def test_distance_and_any_closer():
    i, j = all_pairs(128, 98)
    expected = triangle_triangle(A[0][A[1][i]], B[0][B[1][j]])
    nearest = collision.distance(A, B)
    assert nearest.distance == pytest.approx(expected.min(), rel=1e-9)
    assert expected[nearest.a * 98 + nearest.b] == pytest.approx(expected.min(), rel=1e-9)
    assert np.linalg.norm(nearest.point_a - nearest.point_b) == pytest.approx(nearest.distance)
    back = collision.distance(B, A)
    assert (back.distance, back.a, back.b) == (nearest.distance, nearest.b, nearest.a)
    # The distance is rounded, within one unit in the last place.
    assert collision.any_closer(A, B, threshold=nearest.distance * (1 + 1e-15))
    assert not collision.any_closer(A, B, threshold=nearest.distance * (1 - 1e-15))
    assert not collision.any_closer(A, threshold=1e-6)
    assert collision.distance(A, A).distance == 0.0
    with pytest.raises(ValueError, match="needs a triangle"):
        collision.distance(A[0], B)


def test_a_world_over_frames():
    world = collision.World(threshold=0.12, pairs="vertex-vertex")
    floor = world.add(A, "fixed")
    lid = world.add(B, transform=[0, 0, 5])
    cloth = world.add((A[0] + [10, 0, 0], A[1]), "deforming")
    assert world.update().complete and len(world.contacts()) == 0 and len(world) == 3 and list(world)[1] == lid
    for height in (0.0, 0.01, 3.0):
        world.place(lid, [0, 0, height])
        update = world.update()
        contacts = world.contacts()
        expected = collision.close_pairs(A, B, threshold=0.12, pairs="vertex-vertex", transform_b=[0, 0, height])
        assert update.complete and np.array_equal(contacts["a"], expected.i) and np.array_equal(contacts["b"], expected.j)
        assert np.array_equal(contacts["distance"], expected.distance)
        assert set(contacts["body_a"]) <= {floor.index} and set(contacts["body_b"]) <= {lid.index}
    assert len(world.changes()["ended"]) > 0 and len(world.changes()["begun"]) == 0
    assert world.update().recomputed == 0
    world.deform(cloth, A[0] + [0, 0, 0.01])
    assert [(a.index, b.index) for a, b in world.touching()] == [(floor.index, cloth.index)]
    assert world.first()[:2] == (floor.index, cloth.index)
    world.exclude(floor, cloth)
    assert world.first() is None
    world.include(floor, cloth)
    world.threshold = 0.005
    assert world.threshold == 0.005 and world.first() is None
    assert world.nearest(3)["distance"][0] == pytest.approx(0.01)
    assert world.distance(floor, lid).distance > 2.5
    assert world.cast_ray([0.5, 0.5, 9], [0.5, 0.5, -9])[0] == lid
    assert world.nearest_to_point([0.0, 0.0, 9.0])[0] == lid
    assert world.bodies_in([-1, -1, 2], [2, 2, 4]) == [lid]
    world.remove(lid)
    with pytest.raises(ValueError, match="handle"):
        world.place(lid, None)
    with pytest.raises(ValueError, match="motion"):
        world.add(A, "floating")


def test_a_body_of_another_world_is_refused():
    world, other = (collision.World(threshold=0.12) for _ in range(2))
    floor, lid = world.add(A, "fixed"), world.add(B, transform=[0, 0, 5])
    mine, stranger = other.add(A, "fixed"), other.add(B, transform=[0, 0, 7])
    assert stranger.index == lid.index and stranger != lid and list(world) == [floor, lid]
    for use in (
        lambda: world.place(stranger, None),
        lambda: world.translate(stranger, [0, 0, 1]),
        lambda: world.deform(stranger, B[0]),
        lambda: world.replace(stranger, A),
        lambda: world.set_groups(stranger, 1),
        lambda: world.exclude(floor, stranger),
        lambda: world.include(mine, lid),
        lambda: world.distance(floor, stranger),
        lambda: world.remove(stranger),
    ):
        with pytest.raises(ValueError, match="body [01] is of another world"):
            use()
    assert len(world) == 2 and world.distance(floor, lid).distance > 4


def test_a_translated_body_stays_turned():
    quarter = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 9], [0, 0, 0, 1.0]])
    found = []
    for move in (lambda world, lid: world.translate(lid, [0, 0, 0.01]), lambda world, lid: world.place(lid, quarter)):
        world = collision.World(threshold=0.12, pairs="vertex-vertex")
        floor = world.add(A, "fixed")
        lid = world.add(B, transform=quarter)
        assert world.update().complete and len(world.contacts()) == 0
        quarter[2, 3] = 0.01
        move(world, lid)
        world.update()
        found.append(world.contacts())
        quarter[2, 3] = 9
    assert len(found[0]) > 0 and np.array_equal(found[0], found[1])
    with pytest.raises(ValueError, match="finite"):
        world.translate(lid, [0, 0, np.nan])
    with pytest.raises(ValueError, match="shape"):
        world.translate(lid, [0, 0])
    with pytest.raises(ValueError, match="rigid"):
        world.translate(floor, [0, 0, 1])


def test_a_world_is_used_from_threads():
    from concurrent.futures import ThreadPoolExecutor

    world = collision.World(threshold=0.12)
    world.add(A, "fixed")
    lid = world.add(B)

    def frame(height):
        world.place(lid, [0, 0, height])
        world.update()
        return len(world.contacts())

    with ThreadPoolExecutor(4) as pool:
        assert all(count >= 0 for count in pool.map(frame, np.linspace(0, 1, 40)))


def test_a_deforming_body_has_no_transform():
    world = collision.World(threshold=0.1)
    with pytest.raises(ValueError, match="where its vertices are"):
        world.add(A, "deforming", transform=[0, 0, 5])
