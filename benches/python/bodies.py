"""Many moving bodies, beside the dynamic AABB tree of FCL: `python benches/python/bodies.py`.

    pip install ./crates/satisfice-python python-fcl

Scenes of `cargo bench --bench world`: bodies of radius 0.4 on a loose lattice or in a pile; every moving body has a step of up to 0.005 along each axis.
Only the level of bodies: which pairs of boxes meet. satisfice: `World.translate` of what moves and `World.bodies_in` of an empty region,
which finds the pairs. FCL: `setTranslation` of what moves, `DynamicAABBTreeCollisionManager.update`, and `collide` with a callback that
counts, less what a pair costs where all objects are in one place: the cost of a call into Python is left out. Calls from Python are included in
both; those of FCL's other two columns are few, so that they compare with the times of the same scenes in `docs/results/worlds.md`.
Prints a table of medians of processor time in ms.
"""

import statistics
import time

import fcl
import numpy as np
from satisfice import collision

FRAMES = 15
RADIUS = 0.4
STEP = 0.005


def icosphere():
    """A sphere of 80 triangles."""
    golden = (1 + 5**0.5) / 2
    corners = [(s, t * golden, 0) for s in (1, -1) for t in (1, -1)]
    vertices = np.array([np.roll(c, k) for k in range(3) for c in corners], float)
    faces = np.array(
        [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if all(abs(np.linalg.norm(vertices[a] - vertices[b]) - 2) < 1e-9 for a, b in ((i, j), (j, k), (i, k)))]
    )
    middles = {}
    vertices = list(vertices)

    def middle(a, b):
        key = (min(a, b), max(a, b))
        if key not in middles:
            middles[key] = len(vertices)
            vertices.append((vertices[a] + vertices[b]) / 2)
        return middles[key]

    divided = []
    for a, b, c in faces:
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        divided += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    vertices = np.array(vertices)
    return RADIUS * vertices / np.linalg.norm(vertices, axis=1)[:, None], np.array(divided)


def lattice(bodies, spacing):
    side = round(np.ceil(bodies ** (1 / 3) - 1e-9))
    n = np.arange(bodies)
    return np.stack([n % side, n // side % side, n // side**2], 1) * spacing


def scenes(bodies):
    for every, share in ((0, "0"), (1000, "0.1 %"), (10, "10 %"), (1, "100 %")):
        yield f"lattice, {share} moving", lattice(bodies, 1.0), every
    jitter = np.random.default_rng(7).uniform(0, 0.15, (bodies, 3))
    yield "pile, 100 % moving", lattice(bodies, 0.78) + jitter, 1


class Manager:
    """FCL's tree over spheres."""

    def __init__(self, centres):
        shape = fcl.Sphere(RADIUS)
        self.objects = [fcl.CollisionObject(shape, fcl.Transform(centre)) for centre in centres]
        self.tree = fcl.DynamicAABBTreeCollisionManager()
        self.tree.registerObjects(self.objects)
        self.tree.setup()

    def place(self, body, centre):
        self.objects[body].setTranslation(centre)

    def pairs(self):
        """How many pairs of boxes meet."""
        count = [0]

        def met(first, second, data):
            count[0] += 1
            return False

        self.tree.collide(count, met)
        return count[0]


def taken(run):
    start = time.process_time()
    result = run()
    return (time.process_time() - start) * 1e3, result


def cost_of_a_pair():
    """Milliseconds that FCL and the callback take for a pair where all bodies are in one place."""
    manager = Manager(np.random.default_rng(3).uniform(0, 0.1, (700, 3)))
    return statistics.median(ms / count for ms, count in (taken(manager.pairs) for _ in range(5)))


def compare(name, centres, every, pair):
    shape = collision.mesh(*icosphere())
    world = collision.World(threshold=0.01)
    bodies = [world.add(shape, transform=centre) for centre in centres]
    empty = ([1e6] * 3, [1e6 + 1] * 3)
    world.bodies_in(*empty)
    manager = Manager(centres)
    moved = range(0, len(centres), every) if every else []
    rng = np.random.default_rng(1)
    ways = rng.uniform(-STEP, STEP, centres.shape)
    ours, places, updates, searches = [], [], [], []
    for _ in range(FRAMES):
        centres = centres + ways

        def frame():
            for body in moved:
                world.translate(bodies[body], centres[body])
            world.bodies_in(*empty)

        ours.append(taken(frame)[0])

        def place():
            for body in moved:
                manager.place(body, centres[body])

        places.append(taken(place)[0])
        updates.append(taken(manager.tree.update)[0] if every else 0.0)
        ms, count = taken(manager.pairs)
        searches.append(max(ms - count * pair, 0.0) if every else 0.0)
    ours, place, update, search = (statistics.median(each) for each in (ours, places, updates, searches))
    ratio = f"{(place + update + search) / ours:.2f}" if every else "-"
    row = f"{ours:.3f} | {place:.3f} | {update:.3f} | {search:.3f} | {ratio} | {count}"
    print(f"| {len(centres)} | {name} | {len(moved)} | {row} |", flush=True)


def main():
    pair = cost_of_a_pair()
    print(f"A pair and its callback: {pair * 1e6:.0f} ns.\n")
    print("| bodies | scene | moved | satisfice | FCL: placing | update | pairs | FCL / satisfice | pairs |\n|---|---|---|---|---|---|---|---|---|")
    for bodies in (1000, 10_000):
        for name, centres, every in scenes(bodies):
            compare(name, centres, every, pair)


if __name__ == "__main__":
    main()
