"""`x0=` and `checkpoint=`: a search that goes on from a file gives the report of one that was not interrupted."""

import functools
import os
import signal
import subprocess
import sys
import textwrap
import time

import evaluations
import numpy as np
import pytest
import satisfice
from conftest import same, without_times

SQUARE = [(-2, 2), (-2, 2)]
RING = {"delta": 0.02, "separation": 0.05, "evaluations": 3000, "seed": 1}


def test_start_points_come_first():
    seen = []

    def f(x):
        seen.append(x.copy())
        return evaluations.ring(x)

    starts = [[1.0, 0.0], [0.6, 0.8], [2.0, -2.0]]
    report = satisfice.find(f, SQUARE, **RING, x0=starts)
    assert np.array_equal(seen[:3], starts) and report.evaluation[:2].tolist() == [1, 2]
    assert report.to_dict()["problem_parameters"]["x0"] == starts
    search = satisfice.Search(SQUARE, **RING, x0=starts[0])
    assert search.ask(1).x.tolist() == starts[:1]
    for x0, says in [([3.0, 0.0], "start point"), ([1.0], "shape"), ([np.nan, 0], "start point"), ("a", "could not convert")]:
        with pytest.raises(ValueError, match=says):
            satisfice.find(f, SQUARE, **RING, x0=x0)
    with pytest.raises(ValueError, match="x0 does not apply"):
        satisfice.find(satisfice.problem("queens"), evaluations=10, x0=starts)


def stops_at(count):
    """The ring, for so many calls; then Ctrl-C."""
    calls = []

    def f(x):
        calls.append(x)
        if len(calls) == count:
            raise KeyboardInterrupt
        return evaluations.ring(x)

    return functools.wraps(evaluations.ring)(f)


@pytest.mark.parametrize("islands", [1, 3])
@pytest.mark.parametrize("engine", ["portfolio", "pso", "descent-flood", "random"])
def test_an_interrupted_search_goes_on(tmp_path, islands, engine):
    options = {**RING, "islands": islands, "engine": engine, "probes": 0.1}
    whole = satisfice.find(evaluations.ring, SQUARE, **options)
    file = tmp_path / "search.json"
    calls = 0
    for count in [1, 700, 613]:
        with pytest.raises(KeyboardInterrupt) as raised:
            satisfice.find(stops_at(count), SQUARE, **options, checkpoint=file)
        calls += count - 1
        assert raised.value.report.nfev == calls  # nothing is evaluated twice
    report = satisfice.find(evaluations.ring, SQUARE, **{**options, "seed": None}, checkpoint=file)
    assert same(report, whole) and report.nfev == whole.nfev
    assert same(satisfice.find(stops_at(1), SQUARE, **options, checkpoint=file), whole)  # it is over: nothing is called


def test_kill_9_loses_no_more_than_was_done_since_the_last_save(tmp_path):
    program = """
        import sys, time
        sys.path.insert(0, {tests!r})
        import evaluations, satisfice
        def slow(x):
            time.sleep(0.002)
            return evaluations.ring(x)
        slow.__qualname__, slow.__module__ = "ring", "evaluations"
        satisfice.find(slow, [(-2, 2)] * 2, delta=0.02, separation=0.05, evaluations=3000, seed=1, checkpoint="search.json")
    """
    program = textwrap.dedent(program).format(tests=os.path.dirname(evaluations.__file__))
    process = subprocess.Popen([sys.executable, "-c", program], cwd=tmp_path)
    while True:  # the second save comes after a second
        time.sleep(0.1)
        if process.poll() is not None:
            break
        file = tmp_path / "search.json"
        if file.exists() and b'"fitness_calls":0' not in file.read_bytes()[:100_000]:
            process.send_signal(signal.SIGKILL)
            break
    process.wait()
    report = satisfice.find(evaluations.ring, SQUARE, **RING, checkpoint=tmp_path / "search.json")
    assert same(report, satisfice.find(evaluations.ring, SQUARE, **RING))


def test_islands_go_on_elsewhere(tmp_path):
    options = {**RING, "islands": 3, "options": {"without": "model"}}
    file = tmp_path / "search.json"

    def callback(progress):
        if progress.evaluations > 1000:
            raise LookupError

    with pytest.raises(LookupError):
        satisfice.find(evaluations.ring, SQUARE, **options, checkpoint=file, callback=callback, executor=2)
    report = satisfice.find(evaluations.ring, SQUARE, **options, checkpoint=file)
    assert same(report, satisfice.find(evaluations.ring, SQUARE, **options))


def test_workers_go_on(tmp_path):
    file = tmp_path / "search.json"
    options = {**RING, "evaluations": 400}
    search = satisfice.Search(SQUARE, **options, ordered=True, name="evaluations.ring")
    for _ in range(20):
        batch = search.ask(5)
        search.tell(batch.tickets, [evaluations.ring(x) for x in batch.x])
    search.save(file)
    report = satisfice.find(evaluations.ring, SQUARE, **options, ordered=True, workers=2, checkpoint=file)
    assert same(report, satisfice.find(evaluations.ring, SQUARE, **options))
    assert satisfice.Search.load(file).report().evaluations == 400
    with pytest.raises(ValueError, match="give workers= and executor= as before"):
        satisfice.find(evaluations.ring, SQUARE, **options, checkpoint=file)


def test_a_problem_of_the_catalogue_goes_on(tmp_path):
    problem, file = satisfice.problem("queens", n=10), tmp_path / "queens.json"
    options = {"evaluations": 60_000, "seed": 1, "engine": "pso"}

    def callback(progress):
        raise LookupError

    with pytest.raises(LookupError):
        satisfice.find(problem, **options, callback=callback, checkpoint=file)
    report = satisfice.find(problem, **options, checkpoint=file)
    assert without_times(report.to_json()) == without_times(satisfice.find(problem, **options).to_json())


def test_files_that_do_not_fit(tmp_path):
    file = tmp_path / "search.json"
    satisfice.find(evaluations.ring, SQUARE, **RING, checkpoint=file)
    for change, says in [({"evaluations": 4000}, "evaluations"), ({"engine": "pso"}, "engine"), ({"delta": 0.5}, "threshold")]:
        with pytest.raises(ValueError, match=says):
            satisfice.find(evaluations.ring, SQUARE, **{**RING, **change}, checkpoint=file)
    with pytest.raises(ValueError, match="bounds"):
        satisfice.find(evaluations.ring, [(-1, 2)] * 2, **RING, checkpoint=file)
    with pytest.raises(ValueError, match="has no tickets: `find` saved it"):
        satisfice.Search.load(file)
    file.write_text("{}")
    with pytest.raises(ValueError, match="not a saved search"):
        satisfice.find(evaluations.ring, SQUARE, **RING, checkpoint=file)
    with pytest.raises(FileNotFoundError) as raised:
        satisfice.find(evaluations.ring, SQUARE, **RING, checkpoint=tmp_path / "nowhere" / "search.json")
    assert raised.value.report.nfev < 3000
