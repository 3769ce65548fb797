"""What goes wrong in other processes is told, and they end with the one that searches."""

import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import evaluations
import pytest
import satisfice

SQUARE = [(-2, 2), (-2, 2)]
RING = {"delta": 0.05, "separation": 0.1, "evaluations": 60, "seed": 1}


@pytest.mark.parametrize("how", ["workers", "islands", "executor", "map"])
def test_an_exception_that_cannot_be_unpickled_ends_the_search(how):
    with pytest.raises(RuntimeError, match="the mesh is torn") as raised, ProcessPoolExecutor(1) as pool:
        on = {"workers": 2, "islands": 2, "executor": pool, "map": pool.map}[how]
        options = {"islands": 2, "executor": on} if how == "islands" else {"workers": on}
        satisfice.find(evaluations.raises_unpicklable, SQUARE, **RING, **options)
    text = str(raised.value)
    assert "f raised Unpicklable" in text and "in raises_unpicklable" in text  # where it was raised
    assert raised.value.report.failed == 0


def test_an_exception_is_itself_where_it_can_be():
    with pytest.raises(evaluations.Unpicklable) as raised, ThreadPoolExecutor(2) as pool:
        satisfice.find(evaluations.raises_unpicklable, SQUARE, **RING, workers=pool)
    assert raised.value.report.stop_reason == "Cancelled"
    report = satisfice.find(evaluations.raises_unpicklable, SQUARE, **RING, workers=2, catch=evaluations.Unpicklable)
    assert report.failed == report.nfev == 60


def test_workers_that_always_die_end_the_search():
    with pytest.raises(RuntimeError, match="the first 8 evaluations all failed") as raised:
        satisfice.find(evaluations.exits, SQUARE, **RING, workers=2)
    assert raised.value.report.failed == 7


@pytest.mark.skipif(os.name == "nt", reason="signals and process groups of POSIX")
@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.parametrize("deadly", ["SIGTERM", "SIGKILL"])
def test_workers_end_when_the_searching_process_is_killed(tmp_path, method, deadly):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {method}")
    program = tmp_path / "program.py"
    program.write_text(
        textwrap.dedent(f"""
        import multiprocessing, os, sys, time
        import satisfice
        def slow(x):
            open(str(os.getpid()), "w").close()
            time.sleep(0.05)
            return 1.0
        if __name__ == "__main__":
            multiprocessing.set_start_method({method!r})
            satisfice.find(slow, [(0, 1)] * 2, delta=0, time=60, workers=3)
    """)
    )
    places = tmp_path / "places"
    places.mkdir()
    process = subprocess.Popen([sys.executable, str(program)], cwd=places)
    until = time.monotonic() + 30
    while len(os.listdir(places)) < 3 and time.monotonic() < until:
        time.sleep(0.02)
    workers = [int(name) for name in os.listdir(places)]
    assert len(workers) == 3
    process.send_signal(getattr(signal, deadly))
    process.wait()
    until = time.monotonic() + 10
    while any(map(is_running, workers)) and time.monotonic() < until:
        time.sleep(0.05)
    left = [pid for pid in workers if is_running(pid)]
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    assert not left


def is_running(pid):
    state = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True).stdout.strip()
    return state != "" and not state.startswith("Z")
