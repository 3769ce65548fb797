"""Reading mesh files beside trimesh: `python benches/python/files.py COMMAND [MESH]`.

COMMAND is a release build of the command `satisfice`. Its time is that of a whole process that reads the mesh and a far triangle, whose boxes do not
meet, so that nothing is searched, less that of one that reads two triangles. That of trimesh is its first `trimesh.load(file, process=False)` in a new
process, imports left out. The two take turns. MESH is any file that trimesh reads; without it, an icosphere of 327,680 triangles. Prints a table of
medians in ms.
"""

import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import trimesh

ROUNDS = 11
LOAD = """
import sys, time, trimesh
start = time.perf_counter()
trimesh.load(sys.argv[1], process=False)
print(time.perf_counter() - start)
"""
FAR = "v {0} 0 0\nv {0} 1 0\nv {0} 0 1\nf 1 2 3\n"


def ours(command: str, mesh: pathlib.Path, far: pathlib.Path) -> float:
    """Seconds of a process that reads a mesh and finds nothing, which is exit code 1."""
    start = time.perf_counter()
    ask = [command, "collide", str(mesh), str(far), "--threshold", "1e-9", "--first"]
    done = subprocess.run(ask, capture_output=True, text=True)
    if done.returncode != 1:
        sys.exit(done.stderr)
    return time.perf_counter() - start


def theirs(mesh: pathlib.Path) -> float:
    """Seconds that trimesh takes in a new process."""
    done = subprocess.run([sys.executable, "-c", LOAD, str(mesh)], capture_output=True, text=True, check=True)
    return float(done.stdout)


def written(mesh: trimesh.Trimesh, folder: pathlib.Path) -> dict[str, pathlib.Path]:
    """The mesh in each format."""
    ascii_ply = trimesh.exchange.ply.export_ply(mesh, encoding="ascii")
    contents = {
        "PLY, binary": ("binary.ply", mesh.export(file_type="ply")),
        "PLY, ASCII": ("ascii.ply", ascii_ply),
        "STL, binary": ("binary.stl", mesh.export(file_type="stl")),
        "OBJ": ("text.obj", mesh.export(file_type="obj")),
        "OFF": ("text.off", mesh.export(file_type="off")),
    }
    paths = {}
    for name, (file, content) in contents.items():
        paths[name] = folder / file
        paths[name].write_bytes(content if isinstance(content, bytes) else content.encode())
    return paths


def main() -> None:
    """Writes the files, reads them in turns and prints the table."""
    command = sys.argv[1]
    mesh = trimesh.load(sys.argv[2], process=False) if len(sys.argv) > 2 else trimesh.creation.icosphere(7)
    with tempfile.TemporaryDirectory() as folder_name:
        folder = pathlib.Path(folder_name)
        far = folder / "far.obj"
        far.write_text(FAR.format(10_000))
        near = folder / "near.obj"
        near.write_text(FAR.format(-10_000))
        print(f"{len(mesh.vertices):,} vertices, {len(mesh.faces):,} triangles, {ROUNDS} rounds\n")
        print("| format | MB | satisfice | trimesh | ratio |\n|---|---|---|---|---|")
        for name, path in written(mesh, folder).items():
            rounds = [(ours(command, path, far), ours(command, near, far), theirs(path)) for _ in range(ROUNDS)]
            whole, start, peer = (statistics.median(column) for column in zip(*rounds))
            own, size = whole - start, path.stat().st_size / 1e6
            print(f"| {name} | {size:.1f} | {own * 1e3:.1f} | {peer * 1e3:.1f} | {own / peer:.2f} |")


if __name__ == "__main__":
    main()
