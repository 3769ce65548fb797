"""One frame of a mesh that collides with itself, beside ipctk's broad phase: `python benches/python/self_contact.py [DATA]`.

    pip install ./crates/satisfice-python ipctk

Vertex-triangle and edge-edge pairs together, features that share a vertex left out. Of ipctk `Candidates.build` with two of its broad phases, boxes
grown by half of the threshold: pairs whose boxes meet, no distances; and `NormalCollisions.build`, which decides them. Of satisfice `close_pairs`,
which decides every pair exactly and measures its distance, and a `World` that is deformed, which decides them and keeps its trees. Before each frame the
vertices move at random by up to a thousandth of an edge. DATA is a folder with `cloth_ball92.ply`. Prints a table of medians of
processor time on one thread, all methods in turns.
"""

import statistics
import sys
import time
from pathlib import Path

import ipctk
import numpy as np
from satisfice import collision

KINDS = ["vertex-triangle", "edge-edge"]
PHASES = ["LBVH", "HashGrid"]  # the two fastest here
ROUNDS = 7
LONGEST = 2.0  # seconds; a slower method runs once


def grid(m, n):
    """Triangles of a sheet of m x n vertices."""
    i, j = np.meshgrid(np.arange(m - 1), np.arange(n - 1), indexing="ij")
    a = (i * n + j).ravel()
    return np.concatenate([np.stack([a, a + n, a + 1], 1), np.stack([a + 1, a + n, a + n + 1], 1)])


def folded(m, n, folds):
    """A sheet folded like a map, edges of length 1, its layers one edge apart."""
    width = (m - 1) / folds
    along = np.arange(m)
    x = np.abs((along + width) % (2 * width) - width)
    z = along / width
    x, y = np.broadcast_to(x[:, None], (m, n)), np.broadcast_to(np.arange(n)[None, :], (m, n))
    return np.stack([x, y, np.broadcast_to(z[:, None], (m, n))], 2).reshape(-1, 3).astype(float), grid(m, n)


def crumpled(m, n):
    """A sheet whose vertices are pushed about by half of an edge."""
    vertices, faces = folded(m, n, 1)
    return vertices + np.random.default_rng(1).uniform(-0.5, 0.5, vertices.shape), faces


def read_ply(path):
    """Vertices and triangles of a binary PLY file."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    count = next(int(line.split()[2]) for line in header.decode().split("\n") if line.startswith("element vertex"))
    order = ">" if b"big_endian" in header else "<"
    size = "f8" if b"property double" in header else "f4"
    vertices = np.frombuffer(body, order + size, 3 * count).reshape(-1, 3).astype(float)
    faces = np.frombuffer(body[3 * count * int(size[1]) :], [("n", "u1"), ("v", order + "i4", 3)])["v"]
    return vertices, faces.astype(np.int64)


def scenes(folder):
    yield "folded map, 21,025 vertices", *folded(145, 145, 5), (1.5, 0.5, 0.1)
    yield "crumpled sheet, 21,025 vertices", *crumpled(145, 145), (1.5, 0.5, 0.1)
    if folder and (folder / "cloth_ball92.ply").exists():
        yield "cloth over a ball", *read_ply(folder / "cloth_ball92.ply"), (0.5, 0.1)


def methods(vertices, faces, threshold):
    """Each method: it takes the vertices of a frame and returns the number of its pairs."""
    edges = ipctk.edges(faces.astype(np.int32))
    shell = ipctk.CollisionMesh(np.asfortranarray(vertices), edges, faces.astype(np.int32))

    def candidates(phase):
        def run(frame):
            found = ipctk.Candidates()
            found.build(shell, np.asfortranarray(frame), threshold / 2, getattr(ipctk, phase)())
            return len(found)

        return run

    def decided(frame):
        found = ipctk.NormalCollisions()
        found.build(shell, np.asfortranarray(frame), threshold)
        return len(found)

    def pairs(frame):
        mesh = collision.mesh(frame, faces)
        return sum(len(collision.close_pairs(mesh, threshold=threshold, pairs=kind)) for kind in KINDS)

    worlds = [collision.World(threshold=threshold, pairs=kind) for kind in KINDS]
    bodies = [world.add((vertices, faces), "deforming") for world in worlds]

    def kept(frame):
        for world, body in zip(worlds, bodies):
            world.deform(body, frame)
            world.update()
        return None

    return {
        "`close_pairs`, distances": pairs,
        "`World`": kept,
        **{f"ipctk candidates, {phase}": candidates(phase) for phase in PHASES},
        "ipctk `NormalCollisions`": decided,
    }


def compare(name, vertices, faces, edges_long):
    length = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
    threshold = edges_long * length
    rng = np.random.default_rng(2)
    tasks = methods(vertices, faces, threshold)
    taken, pairs = {task: [] for task in tasks}, {}
    for _ in range(ROUNDS):
        frame = vertices + rng.uniform(-1e-3, 1e-3, vertices.shape) * length
        for task, run in tasks.items():
            if taken[task] and taken[task][0] > LONGEST:
                continue
            start = time.process_time()
            pairs[task] = run(frame)
            taken[task].append(time.process_time() - start)
    times = {task: statistics.median(each) * 1e3 for task, each in taken.items()}
    for task, ms in times.items():
        count = "" if pairs[task] is None else pairs[task]
        ratios = [f"{ms / times[ours]:.2f}" for ours in list(tasks)[:2]]
        print(f"| {name} | {edges_long} | {task} | {count} | {ms:.1f} | {ratios[0]} | {ratios[1]} |", flush=True)


def main():
    ipctk.set_num_threads(1)
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    print("| mesh | threshold, edges | method | pairs | ms | / `close_pairs` | / `World` |\n|---|---|---|---|---|---|---|")
    for name, vertices, faces, thresholds in scenes(folder):
        for edges_long in thresholds:
            compare(name, vertices, faces, edges_long)


if __name__ == "__main__":
    main()
