"""What calls from Python cost, close pairs beside other libraries, and workers: ratios measured side by side.

    PROFILE=release FULL=1 scripts/python.sh        # or: pip install ./crates/satisfice-python scipy trimesh python-fcl distributed
    python benches/python/reach.py > reach.md

Every figure is a median of runs that take turns, so that a machine that does other things slows both sides.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
import satisfice

SQUARE = [(-2.0, 2.0)] * 2


def in_turns(tasks, rounds):
    """Median seconds of each task; all of them run once a round."""
    taken = {name: [] for name in tasks}
    for _ in range(rounds):
        for name, task in tasks.items():
            begun = time.perf_counter()
            said = task()
            taken[name].append(time.perf_counter() - begun if said is None else said)
    return {name: statistics.median(times) for name, times in taken.items()}


def installed(package):
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def constant(x):
    return 1.0


def constants(x, ones=np.ones(4096)):
    return ones[: len(x)]


def overhead(rounds):
    """Seconds a point beside the same engine on a problem in Rust and beside the function itself."""
    print("## A call of f\n")
    print(
        "Uniform points in two dimensions, in batches of 256, f a constant. Per point: `find`, less f called in a loop of Python with the same arrays, "
        "less the same engine on `branin`, whose F is computed in Rust.\n"
    )
    print("| f | find | f alone | Rust | overhead | wanted |")
    print("|---|---|---|---|---|---|")
    branin = satisfice.problem("branin")
    options = {"engine": "random", "options": {"batch": 256}, "seed": 1}
    for vectorized, points, wanted in [(True, 400_000, 0.5), (False, 100_000, 3.0)]:
        f = constants if vectorized else constant
        batch = np.zeros((256, 2))

        def alone():
            for _ in range(points // 256):
                x = batch.copy()
                if vectorized:
                    f(x)
                else:
                    for row in x:
                        f(row)

        taken = in_turns(
            {
                "find": lambda: satisfice.find(f, SQUARE, delta=0, evaluations=points, vectorized=vectorized, **options).elapsed,
                "f": alone,
                "rust": lambda: satisfice.find(branin, evaluations=points, **options).elapsed,
            },
            rounds,
        )
        find, own, rust = (1e6 * taken[name] / points for name in ("find", "f", "rust"))
        name = "`vectorized=True`" if vectorized else "one point a call"
        print(f"| {name} | {find:.3f} us | {own:.3f} us | {rust:.3f} us | {find - own - rust:.3f} us | {wanted} us |", flush=True)


def bumpy(vertices, shift):
    """A sphere with bumps of about so many vertices, from a grid of longitudes and latitudes."""
    rows = max(8, int((vertices / 2) ** 0.5))
    columns = 2 * rows
    t, p = np.meshgrid(np.linspace(0.01, np.pi - 0.01, rows), np.arange(columns) * 2 * np.pi / columns, indexing="ij")
    r = 1 + 0.05 * np.sin(9 * t) * np.cos(7 * p)
    v = np.stack([r * np.sin(t) * np.cos(p), r * np.sin(t) * np.sin(p), r * np.cos(t)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns), indexing="ij")
    a, b = i * columns + j, i * columns + (j + 1) % columns
    faces = np.concatenate([np.stack([a, b, a + columns], -1).reshape(-1, 3), np.stack([b, b + columns, a + columns], -1).reshape(-1, 3)])
    return v + shift, faces


def spacing(v):
    """Typical distance of neighbouring vertices."""
    return 2 * np.pi / (2 * (len(v) / 2) ** 0.5)


def pairs_beside_scipy(most, rounds):
    from scipy.spatial import cKDTree

    print("\n## Close pairs of vertices beside scipy's cKDTree\n")
    print(
        "Two bumpy spheres that cross, all pairs of vertices closer than 1.2 times the spacing, with distances, from numpy arrays to numpy arrays; "
        "trees are built within the time.\n"
    )
    print("| vertices each | pairs | satisfice | `sparse_distance_matrix` | times | `query_ball_tree` (no distances) | times |")
    print("|---|---|---|---|---|---|---|")
    for vertices in [5_000, 20_000, 100_000, 300_000, 1_000_000]:
        if vertices > most:
            break
        (a, _), (b, _) = bumpy(vertices, 0.0), bumpy(vertices, np.array([0.35, 0.2, 0.1]))
        near = 1.2 * spacing(a)
        found = satisfice.collision.close_pairs(a, b, threshold=near, pairs="vertex-vertex")
        theirs = cKDTree(a).sparse_distance_matrix(cKDTree(b), near, output_type="coo_matrix")
        assert len(found.i) == theirs.nnz, (len(found.i), theirs.nnz)
        taken = in_turns(
            {
                "ours": lambda: len(satisfice.collision.close_pairs(a, b, threshold=near, pairs="vertex-vertex").i) and None,
                "sparse": lambda: cKDTree(a).sparse_distance_matrix(cKDTree(b), near, output_type="coo_matrix") is None or None,
                "ball": lambda: cKDTree(a).query_ball_tree(cKDTree(b), near) is None or None,
            },
            rounds if vertices < 200_000 else min(rounds, 3),
        )
        ours, sparse, ball = taken["ours"], taken["sparse"], taken["ball"]
        print(
            f"| {len(a):,} | {len(found.i):,} | {1e3 * ours:.2f} ms | {1e3 * sparse:.1f} ms | {sparse / ours:.1f} | {1e3 * ball:.1f} ms | {ball / ours:.1f} |",
            flush=True,
        )


def write_obj(path, v, f):
    with open(path, "w") as file:
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in v.tolist())
        file.writelines(f"f {a} {b} {c}\n" for a, b, c in (f + 1).tolist())


def pairs_beside_rust(rounds):
    print("\n## Close pairs beside the command\n")
    print(
        "The same pairs by `satisfice collide`, which is Rust alone: its own clock, without reading and writing. Python: from numpy arrays to numpy arrays, "
        "and with the meshes made before.\n"
    )
    print("| pairs | triangles each | found | Rust | numpy | more | meshes made before | more |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for kind, vertices in [("triangle-triangle", 20_000), ("triangle-triangle", 100_000), ("vertex-vertex", 100_000)]:
            meshes = [bumpy(vertices, 0.0), bumpy(vertices, np.array([0.35, 0.2, 0.1]))]
            near = 0.3 * spacing(meshes[0][0]) if kind == "triangle-triangle" else 1.2 * spacing(meshes[0][0])
            paths = [Path(folder) / f"{name}.obj" for name in "ab"]
            for path, mesh in zip(paths, meshes, strict=True):
                write_obj(path, *mesh)
            made = [satisfice.collision.mesh(*mesh) for mesh in meshes]
            command = [sys.executable, "-m", "satisfice", "collide", *map(str, paths), "--threshold", repr(near), "--pairs", kind, "--json", "-"]

            def rust():
                return json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)["elapsed_seconds"]

            taken = in_turns(
                {
                    "rust": rust,
                    "numpy": lambda: len(satisfice.collision.close_pairs(*meshes, threshold=near, pairs=kind).i) and None,
                    "made": lambda: len(satisfice.collision.close_pairs(*made, threshold=near, pairs=kind).i) and None,
                },
                rounds,
            )
            found = len(satisfice.collision.close_pairs(*made, threshold=near, pairs=kind).i)
            more = [100 * (taken[name] / taken["rust"] - 1) for name in ("numpy", "made")]
            print(
                f"| {kind} | {len(meshes[0][1]):,} | {found:,} | {1e3 * taken['rust']:.1f} ms | {1e3 * taken['numpy']:.1f} ms | {more[0]:+.0f} % | "
                f"{1e3 * taken['made']:.1f} ms | {more[1]:+.0f} % |",
                flush=True,
            )


def beside_fcl(rounds):
    if not (installed("trimesh") and installed("python-fcl")):
        print("\ntrimesh and python-fcl are not installed: not compared.")
        return
    import trimesh

    print("\n## Beside trimesh's collision manager (python-fcl)\n")
    print(
        "Whether two bumpy spheres touch, and all pairs of faces that do. trimesh has no pairs within a distance. Building included, and with everything made before.\n"
    )
    print("| question | triangles each | satisfice | trimesh | times | made before | trimesh | times |")
    print("|---|---|---|---|---|---|---|---|")
    for vertices in [5_000, 20_000]:
        arrays = [bumpy(vertices, 0.0), bumpy(vertices, np.array([0.35, 0.2, 0.1]))]
        meshes = [trimesh.Trimesh(*mesh, process=False) for mesh in arrays]
        ours = [satisfice.collision.mesh(*mesh) for mesh in arrays]

        def manager():
            made = trimesh.collision.CollisionManager()
            for name, mesh in zip("ab", meshes, strict=True):
                made.add_object(name, mesh)
            return made

        theirs = manager()
        tiny = 1e-9
        questions = {
            "do they touch": (
                lambda a, b: satisfice.collision.any_closer(a, b, threshold=tiny),
                lambda made: made.in_collision_internal(),
            ),
            "all pairs of faces": (
                lambda a, b: satisfice.collision.close_pairs(a, b, threshold=tiny),
                lambda made: made.in_collision_internal(return_data=True),
            ),
        }
        for question, (we, they) in questions.items():
            taken = in_turns(
                {
                    "ours": lambda: we(*arrays) is None or None,
                    "theirs": lambda: they(manager()) is None or None,
                    "ours made": lambda: we(*ours) is None or None,
                    "theirs made": lambda: they(theirs) is None or None,
                },
                rounds,
            )
            print(
                f"| {question} | {len(arrays[0][1]):,} | {1e3 * taken['ours']:.2f} ms | {1e3 * taken['theirs']:.1f} ms | {taken['theirs'] / taken['ours']:.1f} | "
                f"{1e3 * taken['ours made']:.2f} ms | {1e3 * taken['theirs made']:.2f} ms | {taken['theirs made'] / taken['ours made']:.1f} |",
                flush=True,
            )


def sleeping(x):
    time.sleep(0.01)
    return 1.0


def sleeping_longer(x):
    time.sleep(0.05)
    return 1.0


def busy(x):
    """10 ms of the processor's time, however many share it."""
    end = time.thread_time() + 0.01
    while time.thread_time() < end:
        pass
    return 1.0


def workers(rounds):
    print("\n## Workers\n")
    print(
        "200 evaluations of 10 ms, for Dask also of 50 ms. The start of the processes is not in the time. Bare: the same calls by the executor's own `map`, without a search; "
        "what that loses is the machine's and the executor's.\n"
    )
    print("| f | workers | seconds | one at a time | times | bare | wanted |")
    print("|---|---|---|---|---|---|---|")
    from concurrent.futures import ProcessPoolExecutor

    options = {"delta": 0.5, "evaluations": 200, "seed": 1, "engine": "random"}
    for name, f in [("sleeps", sleeping), ("computes", busy)]:
        with ProcessPoolExecutor(2) as pool:
            list(pool.map(f, range(8)))
            taken = in_turns(
                {
                    "one": lambda: satisfice.find(f, SQUARE, **options).elapsed,
                    "two": lambda: satisfice.find(f, SQUARE, **options, workers=pool).elapsed,
                    "bare": lambda: len(list(pool.map(f, range(200)))) and None,
                },
                rounds,
            )
        times, bare = (taken["one"] / taken[name] for name in ("two", "bare"))
        print(f"| {name} | 2 processes | {taken['two']:.2f} | {taken['one']:.2f} | {times:.2f} | {bare:.2f} | 1.9 |", flush=True)
    if not installed("distributed"):
        print("\nDask is not installed: not measured.")
        return
    import distributed

    with distributed.Client(n_workers=4, threads_per_worker=1, dashboard_address=None) as client:
        client.upload_file(os.path.abspath(__file__))
        client.gather(client.map(sleeping, range(16), pure=False))
        for name, f in [("sleeps", sleeping), ("sleeps 50 ms", sleeping_longer)]:
            taken = in_turns(
                {
                    "one": lambda f=f: satisfice.find(f, SQUARE, **options).elapsed,
                    "four": lambda f=f: satisfice.find(f, SQUARE, **options, workers=client).elapsed,
                    "bare": lambda f=f: len(client.gather(client.map(f, range(200), pure=False))) and None,
                },
                rounds,
            )
            times, bare = (taken["one"] / taken[name] for name in ("four", "bare"))
            print(f"| {name} | 4 of Dask on this machine | {taken['four']:.2f} | {taken['one']:.2f} | {times:.2f} | {bare:.2f} | 3.6 |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--most", type=int, default=1_000_000, help="vertices of the largest comparison with scipy")
    parser.add_argument("--only", choices=["overhead", "scipy", "rust", "fcl", "workers"])
    arguments = parser.parse_args()
    names = ["numpy", "scipy", "trimesh", "python-fcl", "distributed"]
    versions = ", ".join(f"{name} {installed(name)}" for name in names if installed(name))
    print("# Reach of the Python package\n")
    print(f"By `benches/python/reach.py`. Python {platform.python_version()}, {versions}; {os.cpu_count()} cores, load {os.getloadavg()[0]:.0f} at the beginning.\n")
    parts = {
        "overhead": lambda: overhead(arguments.rounds),
        "scipy": lambda: pairs_beside_scipy(arguments.most, arguments.rounds),
        "rust": lambda: pairs_beside_rust(arguments.rounds),
        "fcl": lambda: beside_fcl(arguments.rounds),
        "workers": lambda: workers(min(arguments.rounds, 3)),
    }
    for name, part in parts.items():
        if arguments.only in (None, name):
            part()


if __name__ == "__main__":
    main()
