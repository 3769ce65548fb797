"""Components that a function tells beside its value."""

import functools
import pickle
from concurrent.futures import ThreadPoolExecutor

import evaluations
import numpy as np
import pytest
import satisfice
from conftest import same

CUBE = [(-2, 2)] * 3
CROSSINGS = {"delta": 1e-3, "separation": 0.1, "engine": "surrogate", "evaluations": 40, "seed": 1, "components": 3}


def alone(f=evaluations.crossings, **changes):
    return satisfice.find(f, CUBE, **{**CROSSINGS, **changes})


def value(x):
    return evaluations.crossings(x)[0]


def test_a_model_of_the_components_finds_what_one_of_the_value_misses():
    # Of three points each, over twenty seeds: any one seed may miss the third.
    reports = [alone(seed=seed) for seed in range(20)]
    assert sum(report.hits for report in reports) >= 50
    assert all((report.fun < 1e-3).all() for report in reports)
    assert reports[0].to_dict()["problem_parameters"]["components"] == 3
    assert all(alone(value, components=None, seed=seed).hits == 0 for seed in range(20))
    assert alone(evaluations=60).hits == 3
    by_default = alone(engine="portfolio", evaluations=100)
    assert by_default.hits == 3
    # Engines without a model do not ask for them.
    changes = {"engine": "quadratic-descent", "evaluations": 1000}
    one, two = alone(**changes), alone(value, components=None, **changes)
    assert one.hits > 0 and np.array_equal(one.x, two.x)


@pytest.mark.parametrize("islands", [1, 2])
def test_all_points_at_once_and_in_islands(islands):
    report = alone(islands=islands)
    assert same(report, alone(evaluations.crossings_of_all, vectorized=True, islands=islands))


def test_islands_elsewhere():
    options = {"islands": 2, "evaluations": 80, "probes": 0.2}
    here = alone(**options)
    assert same(here, alone(**options, executor=2))
    assert same(here, alone(evaluations.crossings_of_all, **options, executor=2, vectorized=True))


@pytest.mark.parametrize("engine", ["surrogate", "portfolio"])
def test_tickets(engine):
    options = {**CROSSINGS, "engine": engine}
    for ordered in (True, False):
        search = satisfice.Search(CUBE, **options, ordered=ordered)
        while len(batch := search.ask(3)):
            for ticket, x in reversed(list(zip(batch.tickets, batch.x, strict=True))):
                search.tell(ticket, *evaluations.crossings(x))
            search = pickle.loads(pickle.dumps(search))
        report = search.report()
        assert report.evaluations == 40 and report.hits > 0
        if ordered:
            assert same(report, alone(engine=engine))
    with ThreadPoolExecutor(3) as executor:
        search = satisfice.Search(CUBE, **options, ordered=True)
        assert same(search.run(evaluations.crossings, executor=executor), alone(engine=engine))
    assert same(alone(engine=engine, workers=2, ordered=True), alone(engine=engine))


def test_values_from_elsewhere():
    search = satisfice.Search(CUBE, **CROSSINGS)
    known = np.random.default_rng(1).uniform(-2, 2, (30, 3))
    values, components = evaluations.crossings_of_all(known)
    search.inform(known, values, components)
    report = search.run(evaluations.crossings)
    assert report.hits == 3 and report.evaluation[0] < alone().evaluation[0]


def stops_at(count):
    calls = []

    def f(x):
        calls.append(x)
        if len(calls) == count:
            raise KeyboardInterrupt
        return evaluations.crossings(x)

    return functools.wraps(evaluations.crossings)(f)


@pytest.mark.parametrize("options", [{}, {"batch": 7}])
def test_an_interrupted_search_goes_on(tmp_path, options):
    file = tmp_path / "search.json"
    for count in [5, 11, 9]:
        with pytest.raises(KeyboardInterrupt):
            alone(stops_at(count), options=options, checkpoint=file)
    assert same(alone(options=options, checkpoint=file), alone(options=options))
    with pytest.raises(ValueError, match="components"):
        alone(functools.wraps(evaluations.crossings)(value), options=options, components=None, checkpoint=file)


def test_axes_of_all_kinds():
    def f(x):
        residuals = np.array([np.log10(x[0]) + 4, ((x[1] + 90) % 360 - 180) / 60, x[2] - 3, x[3]])
        return np.abs(residuals).max(), residuals / 0.01

    axes = {"logarithmic": [True, False, False, False], "periodic": [False, True, False, False]}
    axes |= {"integrality": [False, False, True, False], "separation": [0.1, 1, 0, 0.1]}
    options = {"delta": 0.01, "engine": "surrogate", "evaluations": 40, "seed": 1}
    bounds = [(1e-6, 1.0), (0, 360), (0, 9), (-1, 1)]
    report = satisfice.find(f, bounds, components=4, **axes, **options)
    assert report.hits == 1 and report.x[0, 2] == 3 and abs(report.x[0, 1] - 90) < 1
    assert satisfice.find(lambda x: f(x)[0], bounds, **axes, **options).hits == 0


def test_exceptions_that_are_caught_and_components_that_are_no_numbers():
    # Of three points each, over ten seeds: any one seed may miss the third.
    options = {"catch": ArithmeticError, "evaluations": 60}
    reports = [alone(evaluations.diverging_crossings, seed=seed, **options) for seed in range(10)]
    assert all(report.failed > 0 and report.non_finite == report.failed for report in reports)
    assert sum(report.hits for report in reports) >= 28
    report = alone(evaluations.diverging_crossings, catch=ArithmeticError, evaluations=60)
    with pytest.raises(ArithmeticError) as raised:
        alone(evaluations.diverging_crossings, evaluations=60)
    assert raised.value.report.nfev < 60
    workers = alone(evaluations.diverging_crossings, catch=ArithmeticError, evaluations=60, workers=2, ordered=True)
    assert same(workers, report)

    def missing(x):
        value, components = evaluations.crossings(x)
        return value, components if value < 4 else [np.nan, np.inf, components[2]]

    assert alone(missing, evaluations=60).hits > 0


MISTAKES = [
    (lambda x: 1.0, TypeError, r"components=3 it must return a tuple \(value, components\)"),
    (lambda x: (1.0, [0, 0, 0], 2), TypeError, r"it must return a tuple \(value, components\)"),
    (lambda x: (1.0, [0.0, 0.0]), ValueError, r"components of shape \(2,\) at x = .*they must have shape \(3,\)"),
    (lambda x: (1.0, 0.0), ValueError, r"components of shape \(\)"),
    (lambda x: (1.0, ["a", "b", "c"]), TypeError, "they must be real numbers"),
    (lambda x: ([1.0, 2.0], [0, 0, 0]), TypeError, "one real number"),
    (lambda x: (0.0, [0.5, -2.0, 0.0]), ValueError, "a hit, and its components are .*divide each by its limit"),
]


@pytest.mark.parametrize(("f", "error", "says"), MISTAKES)
def test_mistakes_of_a_function(f, error, says):
    with pytest.raises(error, match=says) as raised:
        alone(f)
    assert raised.value.report.hits == 0
    with pytest.raises(error, match=says):
        satisfice.Search(CUBE, **CROSSINGS).run(f)


def test_mistakes_of_a_function_of_all_points():
    for f, error, says in [
        (lambda x: np.zeros(len(x)), TypeError, "must return a tuple"),
        (lambda x: (np.ones(len(x)), np.zeros((3, len(x)))), ValueError, r"they must have shape \(\d+, 3\)"),
        (lambda x: (np.zeros(len(x)), np.full((len(x), 3), 9.0)), ValueError, "divide each by its limit"),
    ]:
        with pytest.raises(error, match=says):
            alone(f, vectorized=True, options={"batch": 2})


def test_mistakes_of_arguments():
    for components, error, says in [
        (evaluations.crossings, TypeError, r"let f return \(value, components\)"),
        (0, ValueError, "components = 0"),
        (1.5, TypeError, "whole number"),
    ]:
        with pytest.raises(error, match=says):
            alone(components=components)
    with pytest.raises(ValueError, match="components does not apply"):
        satisfice.find(satisfice.problem("queens"), evaluations=10, components=2)
    search = satisfice.Search(CUBE, **CROSSINGS)
    tickets = search.ask(1).tickets
    for told, says in [((), "components=3: tell them"), (([[1.0, 2.0]],), "have shape"), (([[9.0] * 3],), "divide")]:
        with pytest.raises(ValueError, match=says):
            search.tell(tickets, [0.0], *told)
    assert len(search.pending) == 1
    with pytest.raises(ValueError, match="has no components"):
        satisfice.Search(CUBE, delta=1.0, evaluations=10).inform([[0, 0, 0]], [0.0], [[0.0]])
