"""`Search`: tickets, saving, workers that are slow, lost or deadly."""

import pickle
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import evaluations
import numpy as np
import pytest
import satisfice
from conftest import same

SQUARE = [(-2, 2), (-2, 2)]
RING = {"delta": 0.05, "separation": 0.1, "evaluations": 300, "seed": 1}


def alone(**changes):
    return satisfice.find(evaluations.ring, SQUARE, **{**RING, **changes})


@pytest.mark.parametrize("ordered", [False, True])
def test_values_are_told_in_any_order(ordered):
    search = satisfice.Search(SQUARE, **RING, ordered=ordered)
    rng = np.random.default_rng(1)
    out = []
    while True:
        batch = search.ask(7)
        assert batch.x.shape == (len(batch), 2)
        out += zip(batch.tickets, batch.x, strict=True)
        if not out:
            break
        for _ in range(min(5, len(out))):
            ticket, x = out.pop(rng.integers(len(out)))
            search.tell(ticket, evaluations.ring(x))
    report = search.report()
    assert report.evaluations == 300 and report.hits == search.hits > 10 and (report.fun < 0.05).all()
    assert search.counts["asked"] == search.counts["taken"] == report.nfev
    if ordered:
        assert same(report, alone())


def test_tickets_are_checked_and_counted():
    search = satisfice.Search(SQUARE, **RING)
    batch = search.ask(3)
    assert batch.tickets.tolist() == [0, 1, 2] and search.pending.tickets.tolist() == [0, 1, 2]
    search.tell(batch.tickets[0], np.nan)
    search.tell(batch.tickets[0], 0.0)
    search.forget(batch.tickets[1])
    search.tell([1], [0.0])
    assert search.counts == {"asked": 3, "taken": 1, "unused": 0, "again": 1, "late": 1, "over": 0, "forgotten": 1}
    assert search.report().non_finite == 1 and search.report().hits == 0
    assert np.array_equal(search.pending.x, batch.x[2:])
    for tickets, values, says in [([99], [0.0], "99"), ([2], [0.0, 1.0], "2 values for 1 tickets"), ([-1], [0.0], "-1")]:
        with pytest.raises(ValueError, match=says):
            search.tell(tickets, values)
    with pytest.raises(TypeError, match="whole numbers"):
        search.tell([0.5], [0.0])


def test_tickets_are_whole_numbers_of_any_kind():
    search = satisfice.Search(SQUARE, **RING)
    batch = search.ask(9)
    search.tell([batch.tickets[0], 1], [1.0, 1.0])  # numpy alone takes these for floats
    search.tell((2, np.int8(3)), [1.0, 1.0])
    search.forget([batch.tickets[4], np.int64(5)])
    search.tell(np.array([6, batch.tickets[7]], dtype=object), [1.0, 1.0])
    assert search.pending.tickets.tolist() == [8]
    search.tell([], [])
    for wrong in ([2**63 + 1, np.int64(3)], [2**64, 1], [2**63, -1]):
        with pytest.raises(ValueError, match="never given out|unknown|ticket"):
            search.tell(wrong, [1.0, 1.0])
    for wrong in ([8.0], [batch.tickets[8], 1.0], [True], ["8"], [None], np.array([8.0])):
        with pytest.raises(TypeError, match="tickets are of type .*: they are whole numbers"):
            search.tell(wrong, [1.0] * len(wrong))
    assert search.counts["taken"] == 6 and search.counts["forgotten"] == 2


def test_values_from_elsewhere_are_entered():
    search = satisfice.Search(SQUARE, **RING)
    search.inform([[1.0, 0.0], [0.0, 1.5]], [0.0, 0.5])
    assert search.hits == 1 and search.report().nfev == 0
    with pytest.raises(ValueError, match="space"):
        search.inform([[9.0, 0.0]], [0.0])
    with pytest.raises(ValueError, match="coordinates"):
        search.inform([[9.0]], [0.0])


@pytest.mark.parametrize("ordered", [False, True])
def test_a_saved_search_goes_on(tmp_path, ordered):
    def finish(search):
        while len(batch := search.ask(4)):
            search.tell(batch.tickets, [evaluations.ring(x) for x in batch.x])
        return search.report()

    search = satisfice.Search(SQUARE, **RING, ordered=ordered)
    for _ in range(20):
        batch = search.ask(4)
        search.tell(batch.tickets[1:], [evaluations.ring(x) for x in batch.x[1:]])
        if not ordered:
            search.tell(batch.tickets[:1], [evaluations.ring(x) for x in batch.x[:1]])
        elif len(search.pending) > 2:
            search.tell(search.pending.tickets, [evaluations.ring(x) for x in search.pending.x])
    search.save(tmp_path / "search.json")
    again = [satisfice.Search.load(tmp_path / "search.json"), pickle.loads(pickle.dumps(search))]
    assert np.array_equal(again[0].pending.tickets, search.pending.tickets)
    search.tell(search.pending.tickets, [evaluations.ring(x) for x in search.pending.x])
    for other in again:
        pending = other.pending
        other.tell(pending.tickets, [evaluations.ring(x) for x in pending.x])
    reports = [finish(search) for search in [search, *again]]
    assert same(reports[0], reports[1]) and same(reports[0], reports[2])
    (tmp_path / "search.json").write_text("{}")
    with pytest.raises(ValueError, match="not a saved search"):
        satisfice.Search.load(tmp_path / "search.json")


@pytest.mark.parametrize("workers", [2, map, "threads", "processes"])
def test_workers_of_any_kind(workers):
    report = None
    if workers == "threads":
        with ThreadPoolExecutor(2) as pool:
            report = alone(workers=pool, ordered=True)
    elif workers == "processes":
        with ProcessPoolExecutor(2) as pool:
            report = alone(workers=pool, ordered=True)
    else:
        report = alone(workers=workers, ordered=True)
    assert same(report, alone())


def test_parallel_is_part_of_the_search_and_the_number_of_workers_is_not():
    report = alone(parallel=4)
    assert report.to_dict()["budget"]["parallel"] == 4
    assert not np.array_equal(report.x, alone().x)
    assert same(report, alone(parallel=4, workers=2, ordered=True))
    assert same(report, alone(parallel=4, workers=map, ordered=True))
    search = satisfice.Search(SQUARE, **RING, parallel=4, ordered=True)
    batch = search.ask(4)
    assert len(batch) == 4
    search.tell(batch.tickets, [evaluations.ring(x) for x in batch.x])
    assert len(search.ask(4)) == 4
    # Workers that need not be ordered say how many they are.
    eager = satisfice.find(evaluations.ring, SQUARE, **RING, workers=2)
    assert eager.to_dict()["budget"]["parallel"] == 2
    with pytest.raises(ValueError, match="parallel"):
        alone(parallel=0)
    with pytest.raises(ValueError, match="1 to 65536"):
        alone(parallel=100_000)


def batches(engine, **changes):
    """How many points an ordered search has at a time, after the first batches."""
    search = satisfice.Search([(-1, 1)] * 4, **{**RING, "evaluations": 1000}, engine=engine, ordered=True, **changes)
    sizes = []
    while len(batch := search.ask(64)) and len(sizes) < 10:
        sizes.append(len(batch))
        search.tell(batch.tickets, (batch.x**2).sum(axis=1))
    return sizes[7:]


def test_which_engines_look_at_parallel_is_as_the_help_says():
    assert sorted(batches("portfolio", parallel=16))[1] >= 16  # now and then one has fewer
    steps = ["walk", "descent", "descent-flood", "quadratic-descent"]
    swarms = [name for name in satisfice.engines() if "pso" in name]
    groups = {1: steps + swarms, 5: ["bounded-swarms"], 64: ["random", "branch-and-bound"]}
    for size, engines in groups.items():
        for engine in engines:
            assert set(batches(engine, parallel=16)) == {size}, engine
    for engine in ["pso", "random", "surrogate"]:
        assert set(batches(engine, options={"batch": 4})) <= {4, 2}  # 30 particles are no multiple of 4
    help_ = satisfice.find.__doc__.split("    parallel : int")[1].split("\n    integrality")[0]
    assert all(f"`{engine}`" in help_ for engine in [*steps, "random", "branch-and-bound", "niching", "restarted-cma-es", "bounded-swarms"])
    assert {"niching", "restarted-cma-es", "surrogate", "portfolio", *steps, *swarms, *groups[5], *groups[64]} == set(satisfice.engines())


def test_eager_workers_do_not_wait():
    report = satisfice.find(evaluations.slow, SQUARE, **{**RING, "evaluations": 100}, workers=2)
    assert report.evaluations == 100 and report.hits > 0


def test_a_worker_that_is_killed_costs_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("SATISFICE_TEST_PLACE", str(tmp_path))
    search = satisfice.Search(SQUARE, **RING, ordered=True)
    report = search.run(evaluations.kills_once, workers=2)
    assert (tmp_path / "killed").exists()
    assert same(report, alone()) and report.failed == 0
    assert search.counts["taken"] == search.counts["asked"]


def test_a_point_that_kills_its_worker_is_given_up():
    report = satisfice.find(evaluations.kills, [(-2, 2)] * 2, **{**RING, "evaluations": 40, "engine": "random"}, workers=2)
    expected = satisfice.find(evaluations.ring, [(-2, 2)] * 2, **{**RING, "evaluations": 40, "engine": "random"})
    assert report.failed == report.non_finite > 0 and report.evaluations == 40 and expected.non_finite == 0


def test_a_broken_executor_of_the_user_leaves_the_search_usable(tmp_path, monkeypatch):
    from concurrent.futures.process import BrokenProcessPool

    monkeypatch.setenv("SATISFICE_TEST_PLACE", str(tmp_path))
    search = satisfice.Search(SQUARE, **RING, ordered=True)
    with pytest.raises(BrokenProcessPool) as raised, ProcessPoolExecutor(2) as pool:
        search.run(evaluations.kills_once, executor=pool, in_flight=2)
    assert 20 < raised.value.report.evaluations < 300
    with ProcessPoolExecutor(2) as pool:
        assert same(search.run(evaluations.ring, executor=pool), alone())


def test_exceptions_of_workers():
    with pytest.raises(ArithmeticError, match="diverged") as raised:
        alone_fails = {**RING, "workers": 2}
        satisfice.find(evaluations.fails, SQUARE, **alone_fails)
    assert raised.value.report.stop_reason == "Cancelled"
    report = satisfice.find(evaluations.fails, SQUARE, **RING, workers=2, catch=ArithmeticError)
    assert report.failed == report.non_finite > 10 and report.evaluations == 300
    with pytest.raises(TypeError, match="top level of a module"):
        satisfice.find(lambda x: 1.0, SQUARE, **RING, workers=2)
    with pytest.raises(TypeError, match="one real number"):
        satisfice.find(str, SQUARE, **RING, workers=map)
    with pytest.raises(ValueError, match="vectorized"):
        satisfice.find(evaluations.ring, SQUARE, **RING, workers=2, vectorized=True)


def test_a_time_ends_a_search_that_waits():
    def never(x):
        time.sleep(1.5)
        return 0.0

    with ThreadPoolExecutor(2) as pool:
        begun = time.monotonic()
        report = satisfice.find(never, SQUARE, delta=1, time=0.3, workers=pool)
        assert time.monotonic() - begun < 1.4
    assert report.stop_reason == "Time" and report.nfev == 0
    with ThreadPoolExecutor(2) as pool:
        search = satisfice.Search(SQUARE, **RING)
        search.run(never, executor=pool, time=0.3, in_flight=2)
        assert len(search.pending) == 2
        with pytest.raises(ValueError, match="give one of them"):
            search.run(evaluations.ring, executor=pool, workers=2)
    assert search.run(evaluations.ring, workers=map).evaluations == 300


def test_dask(tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.Client(n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=tmp_path) as client:
        client.upload_file(str(Path(__file__).with_name("evaluations.py")))
        for workers in [client, client.get_executor()]:
            assert same(alone(workers=workers, ordered=True), alone())
        assert alone(workers=client).evaluations == 300
        with pytest.raises(ArithmeticError, match="diverged"):
            satisfice.find(evaluations.fails, SQUARE, **RING, workers=client)
        processes = client.run(__import__("os").getpid)
        search = satisfice.Search(SQUARE, **RING, ordered=True)
        import threading

        victim = next(iter(processes.values()))
        threading.Timer(0.5, __import__("os").kill, (victim, 9)).start()
        assert same(search.run(evaluations.slow, executor=client), alone())
        assert search.counts["taken"] == search.counts["asked"] and victim not in client.run(__import__("os").getpid).values()
