"""Functions that tests send to other processes."""

import os
import signal
import time
from pathlib import Path


def ring(x):
    return abs((x[0] ** 2 + x[1] ** 2) ** 0.5 - 1.0)


def slow(x):
    time.sleep(0.01)
    return ring(x)


def fails(x):
    if x[0] > 0.5:
        raise ArithmeticError("diverged")
    return ring(x)


def kills_once(x):
    """The 30th call, over all processes, kills its process."""
    place = Path(os.environ["SATISFICE_TEST_PLACE"])
    with open(place / "calls", "ab") as file:
        file.write(b".")
        calls = file.tell()
    if calls >= 30 and not (place / "killed").exists():
        (place / "killed").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.002)
    return ring(x)


def kills(x):
    """Half of the square is a region that no process survives."""
    if x[0] > 0.0:
        os.kill(os.getpid(), signal.SIGKILL)
    return ring(x)


def ring_of_all(x):
    return abs((x[:, 0] ** 2 + x[:, 1] ** 2) ** 0.5 - 1.0)


def slightly_slow(x):
    time.sleep(0.001)
    return ring(x)


def kills_process_once(x):
    """The first call outside the middle kills its process, once over all processes."""
    if x[0] > 1.5:
        try:
            (Path(os.environ["SATISFICE_TEST_PLACE"]) / "killed").touch(exist_ok=False)
        except FileExistsError:
            pass
        else:
            os.kill(os.getpid(), signal.SIGKILL)
    return ring(x)


def crossings(x):
    """Three quantities that are 0 at the same points, three of them in the cube; the components are each divided by its limit."""
    a, b, c = x
    residuals = (a * b - 1.0, b + c * c - 2.0, a - b * c)
    return max(abs(r) for r in residuals), [r / 1e-3 for r in residuals]


def crossings_of_all(x):
    found = [crossings(point) for point in x]
    return [value for value, _ in found], [components for _, components in found]


def diverging_crossings(x):
    if x[0] > 1.9:
        raise ArithmeticError("diverged")
    return crossings(x)


class Unpicklable(Exception):
    """It can be pickled, and not be made again from that."""

    def __init__(self, what, where):
        super().__init__(what)


def raises_unpicklable(x):
    raise Unpicklable("the mesh is torn", x)


def exits(x):
    os._exit(1)
