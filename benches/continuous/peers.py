"""Times the continuous collision of ipctk (Tight Inclusion and additive CCD, default and best settings).

    python3 -m venv venv && venv/bin/pip install ipctk numpy
    venv/bin/python benches/continuous/peers.py DATA PART

DATA is a folder with `cloth_ball92.ply`, `cloth_ball93.ply` and `ccd/cloth-funnel` of the Sample-Scalable-CCD-Data (Apache-2.0). PART is
`version`; `queries`: microseconds a query without the cost of the call from Python, which is measured on features that are far
apart at rest; `candidates`: milliseconds for whole frames; or `free-step:NAME:METHODS`: the collision-free step of a frame and its
milliseconds, a line for each of the methods ACCD (tuned) and TI. Processor time of one thread. `cargo bench --bench continuous` runs it.
"""

import csv
import json
import struct
import sys
import time
from pathlib import Path

import ipctk
import numpy as np

METHODS = {
    "TI default": lambda: ipctk.TightInclusionCCD(),
    "TI 1e-9, 1e5": lambda: ipctk.TightInclusionCCD(1e-9, 100_000, 0.8),
    "ACCD default": lambda: ipctk.AdditiveCCD(),
    "ACCD tuned": lambda: ipctk.AdditiveCCD(10_000_000, 0.9999999),
}

FRAMES = {
    "cloth-funnel": ["ccd/cloth-funnel/227.ply", "ccd/cloth-funnel/228.ply"],
    "cloth-ball": ["cloth_ball92.ply", "cloth_ball93.ply"],
}


def call(method, is_edges, points):
    """Whether a query of eight rows, four at the start and four at the end, touches."""
    query = method.edge_edge_ccd if is_edges else method.point_triangle_ccd
    return query(*points)[0]


def clock(method, is_edges, queries):
    """Microseconds of processor time a query, the largest, and the answers."""
    times, hits = [], []
    start = time.process_time()
    for query in queries:
        before = time.process_time()
        hits.append(call(method, is_edges, query))
        times.append(time.process_time() - before)
    return (time.process_time() - start) / len(queries) * 1e6, max(times) * 1e6, hits


def overhead(method, is_edges):
    apart = [np.array([k * 10.0, (k % 2) * 7.0, 0.0]) for k in range(4)] * 2
    return clock(method, is_edges, [apart] * 2000)[0]


def read_queries(path):
    numbers = []
    with open(path) as file:
        for row in csv.reader(file):
            n = [int(x) for x in row[:6]]
            numbers.append(np.array([n[0] / n[1], n[2] / n[3], n[4] / n[5]]))
    return [numbers[k : k + 8] for k in range(0, len(numbers), 8)]


def read_ply(path):
    """Vertices and triangles of a PLY file with float or double coordinates and one list a face."""
    data = Path(path).read_bytes()
    header, body = data.split(b"end_header\n", 1)
    lines = header.decode().split("\n")
    order = ">" if any("big_endian" in line for line in lines) else "<"
    counts = [int(line.split()[2]) for line in lines if line.startswith("element")]
    kind = "d" if any("property double" in line for line in lines) else "f"
    if any("ascii" in line for line in lines):
        words = iter(body.split())
        vertices = np.array([[float(next(words)) for _ in range(3)] for _ in range(counts[0])])
        faces = np.array([[int(next(words)) for _ in range(4)][1:] for _ in range(counts[1])], dtype=np.int32)
        return vertices, faces
    size = 3 * struct.calcsize(kind)
    vertices = np.frombuffer(body, f"{order}{kind}{struct.calcsize(kind)}".replace("d8", "f8").replace("f4", "f4"), 3 * counts[0])
    faces = np.frombuffer(body[size * counts[0] :], [("n", "u1"), ("v", f"{order}i4", 3)], counts[1])["v"]
    return vertices.reshape(-1, 3).astype(float), faces.astype(np.int32)


def queries(folder):
    print("| queries | method | wrong | us a query | largest us |\n|---|---|---|---|---|")
    for name, is_edges in [("227ee", True), ("227vf", False)]:
        truth = json.loads((folder / "cloth-funnel" / f"{name}_mma_bool.json").read_text())
        asked = read_queries(folder / "cloth-funnel" / f"{name}.csv")
        for title, make in METHODS.items():
            method = make()
            mean, longest, hits = clock(method, is_edges, asked)
            wrong = sum(a != b for a, b in zip(hits, truth))
            base = overhead(method, is_edges)
            print(f"| cloth-funnel {name} | {title} | {wrong} | {mean - base:.2f} | {longest - base:.0f} |")


def frame(data, name):
    first, second = [data / path for path in FRAMES[name]]
    (v0, faces), (v1, _) = read_ply(first), read_ply(second)
    edges = ipctk.edges(faces)
    mesh = ipctk.CollisionMesh(np.asfortranarray(v0), edges, faces)
    return mesh, np.asfortranarray(v0), np.asfortranarray(v1), edges, faces


def whole(data, name, sample):
    mesh, v0, v1, edges, faces = frame(data, name)
    start = time.process_time()
    candidates = ipctk.Candidates()
    candidates.build(mesh, v0, v1, 0.0, ipctk.LBVH())
    broad = (time.process_time() - start) * 1e3
    print(f"| {name} | {len(candidates)} candidates | broad phase | | {broad:.0f} |")
    rng = np.random.default_rng(1)
    for title, make in METHODS.items():
        method = make()
        for is_edges, all_of in [(True, candidates.ee_candidates), (False, candidates.fv_candidates)]:
            picked = [all_of[int(k)] for k in rng.integers(0, len(all_of), sample)]
            asked = []
            for pair in picked:
                ids = pair.vertex_ids(edges, faces)[:4]
                asked.append([v0[i] for i in ids] + [v1[i] for i in ids])
            mean, _, _ = clock(method, is_edges, asked)
            mean -= overhead(method, is_edges)
            kind = "edge-edge" if is_edges else "vertex-face"
            print(f"| {name} | {len(all_of)} {kind} | {title} | {mean:.2f} | {mean * len(all_of) / 1e3:.0f} |")


def free_step(data, name, methods):
    mesh, v0, v1, _, _ = frame(data, name)
    for short in methods:
        method = {"ACCD": METHODS["ACCD tuned"], "TI": METHODS["TI default"]}[short]()
        start = time.process_time()
        step = ipctk.compute_collision_free_stepsize(mesh, v0, v1, 0.0, ipctk.LBVH(), method)
        print(short, step, (time.process_time() - start) * 1e3)


def main():
    data, part = Path(sys.argv[1]), sys.argv[2]
    ipctk.set_num_threads(1)
    if part == "version":
        print(ipctk.__version__)
    elif part == "queries":
        queries(data / "ccd")
    elif part == "candidates":
        print("| step | | method | us a query | ms in all |\n|---|---|---|---|---|")
        whole(data, "cloth-funnel", 5000)
        whole(data, "cloth-ball", 20000)
    else:
        _, name, methods = part.split(":")
        free_step(data, name, methods.split(","))


if __name__ == "__main__":
    main()
