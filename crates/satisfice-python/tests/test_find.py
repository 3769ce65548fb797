"""`find` on functions: results, arguments, values of any kind."""

import numpy as np
import pytest
import satisfice
from conftest import without_times

SQUARE = [(-2, 2), (-2, 2)]
CIRCLE = {"delta": 0.01, "separation": 0.2, "seed": 1}


def test_patience_ends_the_search(circle):
    report = satisfice.find(circle, [(-2, 2)] * 2, delta=0.05, separation=0.1, patience=300, seed=1)
    assert report.hits > 10
    assert report.evaluations == report.trace["evaluations"][-1] == int(report.evaluation[-1]) + 300


def test_hits_are_distinct_and_below_delta(circle):
    report = satisfice.find(circle, SQUARE, evaluations=20_000, **CIRCLE)
    assert report.x.shape == (report.hits, 2) == (len(report), 2) and report.hits >= 15
    assert report.fun.tolist() == [circle(x) for x in report.x]
    assert (report.fun < 0.01).all()
    apart = np.linalg.norm(report.x[:, None] - report.x[None, :], axis=2) + 9 * np.eye(report.hits)
    assert apart.min() > 0.2
    assert (np.diff(report.evaluation.astype(int)) > 0).all() and (np.diff(report.time) >= 0).all()
    assert report.evaluations == 20_000 and report.nfev <= 20_000
    assert report.stop_reason == "Evaluations" and report.completeness == "Unknown"
    assert report.best.fun == report.fun.min() and circle(report.best.x) == report.best.fun


@pytest.mark.parametrize("engine", ["portfolio", "random", "latest-hit-qpso", "descent-flood", "restarted-cma-es"])
def test_a_vectorized_function_gives_the_same_report(engine):
    shapes = []

    def all_at_once(x):
        shapes.append(x.shape)
        return x[:, 0] * x[:, 0] + x[:, 1]

    options = {"delta": -1.5, "separation": 0.05, "evaluations": 1000, "engine": engine, "seed": 3}
    one = satisfice.find(lambda x: x[0] * x[0] + x[1], SQUARE, **options)
    all_ = satisfice.find(all_at_once, SQUARE, vectorized=True, **options)
    ours, theirs = without_times(one.to_json()), without_times(all_.to_json())
    del ours["problem_parameters"]["function"], theirs["problem_parameters"]["function"]
    assert ours == theirs and one.hits > 5
    assert {len(shape) for shape in shapes} == {2} and sum(shape[0] for shape in shapes) == all_.nfev


def test_the_same_seed_gives_the_same_report_and_a_drawn_one_is_told(circle):
    drawn = satisfice.find(circle, SQUARE, delta=0.01, evaluations=2000)
    again = satisfice.find(circle, SQUARE, delta=0.01, evaluations=2000, seed=drawn.seed)
    other = satisfice.find(circle, SQUARE, delta=0.01, evaluations=2000)
    assert without_times(drawn.to_json()) == without_times(again.to_json())
    assert other.seed != drawn.seed


def test_integers_and_categories():
    def f(x):
        assert x[0] == int(x[0]) and x[2] in (0, 1)
        return abs(x[0] - 3) + abs(x[1]) + (5 if x[2] == 0 else 0)

    bounds = [(0, 9), (-1, 1), None]
    options = {"integrality": [True, False, False], "categories": {2: ["red", "green"]}}
    report = satisfice.find(f, bounds, delta=1.0, separation=0.5, evaluations=5000, seed=1, **options)
    assert report.hits >= 3 and set(report.x[:, 2]) == {1.0} and set(report.x[:, 0]) == {3.0}
    assert report.to_dict()["problem_parameters"]["categories"] == {"2": ["red", "green"]}


def test_logarithmic_and_periodic_axes():
    def f(x):
        return abs(np.log10(x[0]) + 4) + abs((x[1] + 180) % 360 - 180)

    report = satisfice.find(
        f, [(1e-6, 1.0), (0, 360)], delta=0.5, logarithmic=[True, False], periodic=[False, True], separation=[0.1, 0.1],
        evaluations=3000, seed=1,
    )  # fmt: skip
    assert report.hits > 20 and (report.fun < 0.5).all()
    assert report.x[:, 1].min() < 0.5 and report.x[:, 1].max() > 359.5, "both sides of north"
    said = report.to_dict()["problem_parameters"]
    assert (said["logarithmic"], said["periodic"]) == ([True, False], [False, True])
    # Uniform points: half of them lie below the geometric mean.
    points = satisfice.Search([(1e-6, 1.0)], delta=0.5, logarithmic=True, evaluations=400, engine="random", seed=1).ask(400).x
    assert 150 < (points < 1e-3).sum() < 250


def test_permutations():
    def f(x):
        order = list(x[1:])
        assert sorted(order) == [0, 1, 2, 3]
        return sum(place != want for place, want in zip(order, [2, 0, 3, 1], strict=True)) + abs(x[0])

    report = satisfice.find(f, [(-1, 1)] + [None] * 4, delta=0.5, permutations=[range(1, 5)], separation=0.1, evaluations=3000, seed=1)
    assert report.hits > 3 and {tuple(x) for x in report.x[:, 1:]} == {(2, 0, 3, 1)}
    assert report.to_dict()["problem_parameters"]["permutations"] == [[1, 2, 3, 4]]


def test_an_all_integer_space_is_covered():
    report = satisfice.find(lambda x: x.sum(), [(0, 30)] * 2, delta=3, integrality=True, evaluations=5000, seed=1)
    assert sorted(map(tuple, report.x)) == [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (2, 0)]


def test_separation_per_axis():
    report = satisfice.find(
        lambda x: 0.0, [(0, 1), (0, 1)], delta=1, separation=[0.1, 10.0], evaluations=5000, engine="random", seed=1
    )
    assert report.hits <= 11
    assert np.diff(np.sort(report.x[:, 0])).min() > 0.1


def test_bounds_of_scipy():
    class Bounds:
        lb, ub = np.array([-2.0, -2.0]), np.array([2.0])

    ours = satisfice.find(lambda x: x.sum(), Bounds(), delta=-3, evaluations=500, seed=1)
    theirs = satisfice.find(lambda x: x.sum(), SQUARE, delta=-3, evaluations=500, seed=1)
    assert np.array_equal(ours.x, theirs.x) and ours.hits > 0


@pytest.mark.parametrize(
    "value",
    [
        lambda x: np.float32(x[0] * 0),
        lambda x: int(0),
        lambda x: np.array(0.0),
        lambda x: False,
        lambda x: np.int8(0),
        lambda x: np.longdouble(0),
    ],
)
def test_values_of_any_real_type(value):
    assert satisfice.find(value, SQUARE, delta=0.5, evaluations=50, seed=1).hits > 0


@pytest.mark.parametrize(
    "layout",
    [
        lambda y: y,
        lambda y: y.astype(np.float32),
        lambda y: y.astype(">f8"),
        lambda y: list(y),
        lambda y: tuple(y),
        lambda y: np.repeat(y, 2)[::2],
        lambda y: y[::-1].copy()[::-1],
        lambda y: np.asfortranarray(y),
        lambda y: [y.setflags(write=False), y][1],
        lambda y: memoryview(y.copy()),
    ],
)
def test_vectorized_values_of_any_layout(layout):
    def values(x):
        return np.round(64 * (x[:, 0] + x[:, 1])) / 64  # the same number in single precision

    def f(x):
        return layout(values(x))

    report = satisfice.find(f, SQUARE, delta=-1, vectorized=True, evaluations=500, seed=1)
    expected = satisfice.find(values, SQUARE, delta=-1, vectorized=True, evaluations=500, seed=1)
    assert np.array_equal(report.x, expected.x) and report.hits > 5


@pytest.mark.parametrize(
    ("f", "error", "says"),
    [
        (lambda x: None, TypeError, "one real number"),
        (lambda x: "1", TypeError, "one real number"),
        (lambda x: 1j, TypeError, "one real number"),
        (lambda x: x, TypeError, "vectorized=True"),
    ],
)
def test_values_that_are_no_numbers(f, error, says):
    with pytest.raises(error, match=says) as raised:
        satisfice.find(f, SQUARE, delta=0, evaluations=50, seed=1)
    assert raised.value.report.evaluations == 0


@pytest.mark.parametrize(
    ("f", "error", "says"),
    [
        (lambda x: 1.0, ValueError, r"must return shape \(\d+,\)"),
        (lambda x: x, ValueError, r"must return shape \(\d+,\)"),
        (lambda x: x[1:, 0], ValueError, r"must return shape \(\d+,\)"),
        (lambda x: x[:, 0] * 1j, TypeError, "real numbers"),
        (lambda x: np.array(["a"] * len(x)), TypeError, "real numbers"),
    ],
)
def test_vectorized_values_that_do_not_fit(f, error, says):
    with pytest.raises(error, match=says):
        satisfice.find(f, SQUARE, delta=0, vectorized=True, evaluations=500, seed=1)


def test_nan_is_never_a_hit_and_is_counted():
    report = satisfice.find(
        lambda x: np.nan if x[0] < 0 else -np.inf if x[1] < 0 else 0.0, SQUARE, delta=1, evaluations=2000, seed=1, engine="random"
    )
    assert (report.x >= 0).all() and report.hits > 100
    assert report.non_finite == report.nfev - report.hits and report.failed == 0


def test_the_function_may_change_and_keep_its_argument():
    kept = []

    def careless(x):
        value = float(x[0] ** 2 + x[1])
        x[:] = 99.0
        kept.append(x)
        return value

    careful = satisfice.find(lambda x: float(x[0] ** 2 + x[1]), SQUARE, delta=-1.5, evaluations=2000, seed=1)
    assert np.array_equal(satisfice.find(careless, SQUARE, delta=-1.5, evaluations=2000, seed=1).x, careful.x)
    assert (np.array(kept) == 99.0).all()


def test_no_hit_is_no_error():
    report = satisfice.find(lambda x: 1.0, SQUARE, delta=0, evaluations=100, seed=1)
    assert report.hits == 0 and report.x.shape == (0, 2) and report.best.fun == 1.0


def test_probes_estimate_what_is_missing():
    report = satisfice.find(
        lambda x: x.sum(), [(0, 99)] * 2, delta=5, integrality=True, evaluations=2000, engine="random", probes=0.2, seed=1
    )
    low, high = report.unseen_interval
    assert low <= 15 - report.hits <= high and report.unseen_estimate is not None


def test_islands():
    report = satisfice.find(lambda x: x.sum(), [(0, 99)] * 2, delta=5, integrality=True, evaluations=4000, islands=4, seed=1)
    assert report.hits == 15 and report.to_dict()["islands"] == 4


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"evaluations": None}, ValueError, "nothing limits the search"),
        ({"evaluations": 0}, ValueError, "evaluations = 0"),
        ({"evaluations": 1.5}, TypeError, "whole number"),
        ({"time": -1}, ValueError, "time = -1"),
        ({"time": float("nan")}, ValueError, "time"),
        ({"bounds": None}, ValueError, "bounds is missing"),
        ({"bounds": []}, ValueError, "no axis"),
        ({"bounds": [(1, 0)]}, ValueError, "above the upper"),
        ({"bounds": [(0, float("inf"))]}, ValueError, "finite"),
        ({"bounds": [3]}, ValueError, "axis 0"),
        ({"bounds": [(0, 1.5)], "integrality": True}, ValueError, "whole ends"),
        ({"integrality": [True]}, ValueError, "1 entries for 2 axes"),
        ({"categories": {7: ["a"]}}, ValueError, "axis 7"),
        ({"categories": {1: "aba"}}, ValueError, "two categories are called `a`"),
        ({"logarithmic": True}, ValueError, "lower bound above 0"),
        ({"periodic": [True]}, ValueError, "periodic has 1 entries"),
        ({"permutations": [[1, 0]]}, ValueError, "follow each other"),
        ({"permutations": [[]]}, ValueError, "empty group"),
        ({"permutations": [[0, 1]], "categories": {1: "ab"}}, ValueError, "axis 1 is named twice"),
        ({"categories": {1: "ab"}, "periodic": [False, True]}, ValueError, "cannot be periodic"),
        ({"delta": None}, ValueError, "delta is missing"),
        ({"delta": float("nan")}, ValueError, "NaN"),
        ({"separation": 0}, ValueError, "separation"),
        ({"separation": [0.1]}, ValueError, "separation"),
        ({"engine": "portfolo"}, ValueError, "did you mean `portfolio`"),
        ({"options": {"particle": 3}, "engine": "pso"}, ValueError, "did you mean `particles`"),
        ({"options": {"particles": 0}, "engine": "pso"}, ValueError, "particles = 0"),
        ({"seed": -1}, ValueError, "seed = -1"),
        ({"f": 3}, TypeError, "callable"),
        ({"threads": 2}, ValueError, "threads"),
        ({"probes": 0.9}, ValueError, "probes"),
        ({"callback": 3}, TypeError, "callable"),
    ],
)
def test_arguments_that_are_not_usable(circle, change, error, says):
    arguments = {"f": circle, "bounds": SQUARE, "delta": 0.1, "evaluations": 100, **change}
    with pytest.raises(error, match=says):
        satisfice.find(**arguments)


def test_the_callback_is_told_and_can_end_the_search():
    seen = []

    def callback(progress):
        seen.append(progress)
        return progress.evaluations > 500

    report = satisfice.find(lambda x: x.sum(), SQUARE, delta=-3, time=30, seed=1, callback=callback)
    assert report.stop_reason == "Observer" and report.elapsed < 10
    assert seen[-1].evaluations > 500 and 0 <= seen[-1].share <= 1 and seen[-1].hits <= report.hits


def test_a_time_budget_ends_between_two_calls():
    import time

    def slow(x):
        time.sleep(0.02)
        return x.sum()

    report = satisfice.find(slow, SQUARE, delta=0, time=0.3, seed=1)
    assert report.stop_reason == "Time" and 0.3 <= report.elapsed < 0.6
    assert 5 < report.nfev <= 16 and report.hits > 0


def test_searches_can_be_nested_and_run_in_threads():
    from concurrent.futures import ThreadPoolExecutor

    def inner(x):
        return satisfice.find(lambda y: abs(y[0] - x[0]), [(-2, 2)], delta=0.5, evaluations=20, seed=1).best.fun

    def outer(seed):
        return satisfice.find(inner, [(-2, 2)], delta=0.1, evaluations=50, seed=seed).fun.tolist()

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(outer, range(4))) == [outer(seed) for seed in range(4)]
