"""Islands in other processes: the report is that of islands here, whatever becomes of the workers."""

import os
import signal
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import evaluations
import numpy as np
import pytest
import satisfice
from conftest import same

SQUARE = [(-2, 2), (-2, 2)]
# A model of F is part of what `test_checkpoint` saves and goes on with; here it would only take time.
RING = {"delta": 0.02, "separation": 0.05, "evaluations": 12_000, "islands": 4, "seed": 1, "options": {"without": "model"}}


@pytest.fixture(scope="module")
def here():
    return satisfice.find(evaluations.ring, SQUARE, **RING)


@pytest.mark.parametrize("executor", [2, "processes", "threads"])
def test_any_executor_gives_the_report_of_islands_here(executor, here):
    assert here.hits > 20
    if executor == "processes":
        with ProcessPoolExecutor(2) as pool:
            report = satisfice.find(evaluations.ring, SQUARE, **RING, executor=pool)
    elif executor == "threads":
        with ThreadPoolExecutor(3) as pool:
            report = satisfice.find(evaluations.ring, SQUARE, **RING, executor=pool)
    else:
        report = satisfice.find(evaluations.ring, SQUARE, **RING, executor=executor)
    assert same(report, here)


def test_vectorized_probes_and_starts_are_as_here():
    options = {**RING, "evaluations": 1500, "probes": 0.2, "vectorized": True, "x0": [[1.0, 0.0], [0.0, -1.0], [0.5, 0.5]]}
    report = satisfice.find(evaluations.ring_of_all, SQUARE, **options, executor=2)
    assert same(report, satisfice.find(evaluations.ring_of_all, SQUARE, **options))
    assert report.unseen_interval is not None


def test_patience_alone_ends_the_search_and_a_callback_is_told():
    options = {**RING, "evaluations": None, "patience": 400}
    shares = []
    report = satisfice.find(evaluations.ring, SQUARE, **options, executor=2, callback=lambda progress: shares.append(progress.share))
    assert report.stop_reason == "Patience"
    assert shares
    assert set(shares) == {0.0}


def test_a_killed_worker_costs_nothing(tmp_path, monkeypatch, here):
    monkeypatch.setenv("SATISFICE_TEST_PLACE", str(tmp_path))
    report = satisfice.find(evaluations.kills_process_once, SQUARE, **RING, executor=2)
    assert (tmp_path / "killed").exists()
    assert same(report, here)


def test_a_function_that_kills_every_worker_is_told(tmp_path, monkeypatch):
    with pytest.raises(BrokenProcessPool) as raised:
        satisfice.find(evaluations.kills, SQUARE, **RING, executor=2)
    assert raised.value.report.evaluations == 0


def test_exceptions_and_caught_ones():
    with pytest.raises(ArithmeticError, match="diverged") as raised:
        satisfice.find(evaluations.fails, SQUARE, **RING, executor=2)
    assert raised.value.report.stop_reason == "Cancelled"
    report = satisfice.find(evaluations.fails, SQUARE, **{**RING, "evaluations": 1200}, executor=2, catch=ArithmeticError)
    assert same(report, satisfice.find(evaluations.fails, SQUARE, **{**RING, "evaluations": 1200}, catch=ArithmeticError))
    assert report.failed == report.non_finite > 50
    with pytest.raises(TypeError, match="top level of a module"):
        satisfice.find(lambda x: 1.0, SQUARE, **RING, executor=2)
    with pytest.raises(ValueError, match="give one of them"):
        satisfice.find(evaluations.ring, SQUARE, **RING, executor=2, workers=2)
    with pytest.raises(TypeError, match="no executor"):
        satisfice.find(evaluations.ring, SQUARE, **RING, executor="cluster")
    with pytest.raises(ValueError, match="executor does not apply"):
        satisfice.find(satisfice.problem("queens"), evaluations=100, islands=2, executor=2)


def test_ctrl_c_keeps_what_was_exchanged():
    threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt) as raised, ThreadPoolExecutor(2) as pool:
        satisfice.find(evaluations.slightly_slow, SQUARE, delta=0.1, separation=0.05, time=60, islands=2, executor=pool)
    assert time.monotonic() - begun < 10
    assert raised.value.report.hits > 0


def test_a_time_and_a_callback_end_the_search():
    begun = time.monotonic()
    options = {"delta": 0.1, "separation": 0.05, "islands": 2, "executor": 2}
    report = satisfice.find(evaluations.slightly_slow, SQUARE, **options, time=1.0)
    assert report.stop_reason == "Time" and report.hits > 0 and time.monotonic() - begun < 5
    seen = []

    def callback(progress):
        seen.append(progress)
        return progress.evaluations > 1000

    report = satisfice.find(evaluations.ring, SQUARE, **options, evaluations=10**6, callback=callback)
    assert report.stop_reason == "Observer" and 1000 < report.evaluations < 10_000
    assert [now.evaluations for now in seen] == sorted(now.evaluations for now in seen)


def test_islands_on_dask(tmp_path, here):
    distributed = pytest.importorskip("distributed")
    with distributed.Client(n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=tmp_path) as client:
        client.upload_file(str(Path(__file__).with_name("evaluations.py")))
        assert same(satisfice.find(evaluations.ring, SQUARE, **RING, executor=client), here)
        victim = next(iter(client.run(os.getpid).values()))
        timer = threading.Timer(0.4, os.kill, (victim, 9))
        timer.start()
        slow = {**RING, "evaluations": 2000}
        report = satisfice.find(evaluations.slightly_slow, SQUARE, **slow, executor=client)
        timer.join()
        assert same(report, satisfice.find(evaluations.ring, SQUARE, **slow))
        assert np.isin(report.fun, [evaluations.ring(x) for x in report.x]).all()
