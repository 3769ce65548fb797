"""Arguments that cannot be used: the error names the argument and says what to give."""

import math
from fractions import Fraction
from multiprocessing.pool import ThreadPool

import numpy as np
import pytest
import satisfice
from satisfice import collision

SQUARE = [(-1, 1)] * 2
TRIANGLE = ([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]])


def norm(x):
    return float((x**2).sum())


def find(**given):
    return satisfice.find(norm, SQUARE, **{"delta": 0.1, "separation": 0.1, "evaluations": 20, "seed": 1, **given})


def search(**given):
    return satisfice.Search(SQUARE, **{"delta": 0.1, "separation": 0.1, "evaluations": 20, "seed": 1, **given})


def pairs(**given):
    return collision.close_pairs(TRIANGLE, TRIANGLE, **{"threshold": 0.1, **given})


def asked():
    begun = search()
    return begun, begun.ask(1).tickets


def world():
    return collision.World(threshold=0.1)


def step():
    moving = collision.Step()
    moving.add(TRIANGLE, TRIANGLE[0])
    return moving


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (lambda: find(evaluations=-1), ValueError, "evaluations = -1"),
        (lambda: find(hits="3"), TypeError, "hits must be a whole number"),
        (lambda: find(workers=0), ValueError, "workers = 0 is not allowed: a whole number from 1 to 1024"),
        (lambda: find(workers=10**6), ValueError, "workers = 1000000"),
        (lambda: find(workers=-2), ValueError, "workers = -2"),
        (lambda: find(executor=0), ValueError, "executor = 0"),
        (lambda: find(catch=3), TypeError, "catch must be an exception type .* not 3"),
        (lambda: find(catch=(ValueError, "no")), TypeError, "catch must be"),
        (lambda: find(time=0), ValueError, r"time = 0\.0 is not allowed: a positive number of seconds"),
        (lambda: find(time="1"), TypeError, "time must be a real number, not '1'"),
        (lambda: find(time=math.inf), ValueError, "time = inf"),
        (lambda: find(delta="1"), TypeError, "delta must be a real number"),
        (lambda: find(delta=1j), TypeError, "delta must be a real number"),
        (lambda: find(delta=10**400), ValueError, "delta is too large"),
        (lambda: find(separation=["1", 1]), TypeError, "separation must be a real number"),
        (lambda: satisfice.find(norm, [("0", "1")], delta=0.1, evaluations=9), ValueError, r"bounds of axis 0 are \('0', '1'\)"),
        (lambda: find(time=1e300), ValueError, r"^time = 1e\+300 is not allowed: at most 1e19 seconds, or None for no limit$"),
        (lambda: find(evaluations=True), TypeError, "evaluations must be a whole number, not True"),
        (lambda: find(seed=True), TypeError, "seed must be a whole number, not True"),
        (lambda: find(workers=True), TypeError, "workers must be a whole number, not True"),
        (lambda: find(workers=1.5), TypeError, "workers must be a whole number"),
        (lambda: find(workers="x"), TypeError, "workers must be a number of processes, a function such as pool.map.* not 'x'"),
        (lambda: search().run(norm, workers="x"), TypeError, "workers must be a number of processes"),
        (lambda: find(executor="x"), TypeError, "'x' is no executor: give a number of processes"),
        (lambda: find(executor=map), TypeError, "is no executor"),
        (lambda: find(integrality=["yes", "no"]), TypeError, "integrality must be True or False, .* not 'yes'"),
        (lambda: find(periodic="no"), TypeError, "periodic must be True or False"),
        (lambda: find(integrality=[2, 0]), TypeError, "integrality must be True or False, .* not 2"),
        (lambda: find(categories=[["a"]]), TypeError, r"categories must map axes to their labels, such as \{2: \['steel'"),
        (lambda: find(categories={1: 3}), TypeError, r"categories of axis 1 must be its labels, such as \['steel'.* not 3"),
        (lambda: find(categories={"b": ["a"]}), TypeError, "categories names axis 'b': axes are whole numbers"),
        (lambda: find(permutations=range(0, 2)), TypeError, r"permutations must be groups of axes, such as .* not range\(0, 2\)"),
        (lambda: find(permutations=3), TypeError, "permutations must be groups of axes"),
        (lambda: find(permutations=[[0, "1"]]), TypeError, "permutations names axis '1': axes are whole numbers"),
        (lambda: satisfice.find(norm, 3, delta=0.1, evaluations=9), TypeError, "bounds must be a sequence .* not 3"),
        (lambda: find(x0=[1j, 0]), ValueError, "x0 must be real numbers"),
        (lambda: search().ask(-1), ValueError, "n = -1 is not allowed: a whole number from 0"),
        (lambda: search().ask(10**30), ValueError, "n = 10000"),
        (lambda: search().ask(1.5), TypeError, r"n must be a whole number, not 1\.5"),
        (lambda: search().run(norm, workers=0), ValueError, "workers = 0"),
        (lambda: search().run(norm, in_flight=0), ValueError, "in_flight = 0"),
        (lambda: search().run(norm, time=-1), ValueError, "time = -1"),
        (lambda: search().run(norm, catch=3), TypeError, "catch must be"),
        (lambda: (lambda begun, tickets: begun.tell(tickets, None))(*asked()), ValueError, "values must be real .* None"),
        (lambda: (lambda begun, tickets: begun.tell(tickets, "1"))(*asked()), ValueError, "values must be real numbers"),
        (lambda: search().inform([0, None], 1.0), ValueError, "x must be real numbers"),
        (lambda: pairs(threshold="1"), TypeError, "threshold must be a real number, not '1'"),
        (lambda: pairs(limit=-1), ValueError, "limit = -1"),
        (lambda: pairs(limit=0), ValueError, "limit = 0 is not allowed: a whole number from 1"),
        (lambda: pairs(time=0), ValueError, "time = 0"),
        (lambda: pairs(threads=-1), ValueError, "threads = -1"),
        (lambda: collision.close_pairs(TRIANGLE, threshold=1, ring=-1), ValueError, "ring = -1"),
        (lambda: collision.close_pairs(TRIANGLE, threshold=1, ring=None), TypeError, "ring must be a whole number"),
        (lambda: world().add(TRIANGLE, groups=-1), ValueError, "groups = -1"),
        (lambda: world().add(TRIANGLE, mask=2**32), ValueError, "mask = 4294967296"),
        (lambda: world().update(limit=0), ValueError, "limit = 0"),
        (lambda: world().nearest(-1), ValueError, "count = -1"),
        (lambda: world().cast_ray("abc", [0, 0, 0]), ValueError, "start must be real numbers"),
        (lambda: world().nearest_to_point([0, 0]), ValueError, "point has shape"),
        (lambda: step().impacts(tolerance="1"), TypeError, "tolerance must be"),
        (lambda: step().free_step(time=0), ValueError, "time = 0"),
        (lambda: step().set_motion(-1, TRIANGLE[0], TRIANGLE[0]), ValueError, "body = -1"),
        (lambda: collision.mesh([["0", "0", "0"]]), ValueError, "vertices must be real numbers"),
        (lambda: collision.mesh(np.zeros((2, 3), complex)), ValueError, "vertices must be real numbers"),
        (lambda: collision.mesh([[None, 0, 0]]), ValueError, "vertices must be real numbers"),
        (lambda: collision.mesh([[0, 0], [0, 0, 0]]), ValueError, "vertices must be real numbers"),
        (lambda: collision.mesh(np.ma.masked_equal([[0.0, 1, 2]], 1)), ValueError, "vertices must have no masked"),
        (lambda: collision.mesh(TRIANGLE[0], np.ma.masked_equal([[0, 1, 2]], 1)), ValueError, "faces must have no masked"),
    ],
)
def test_an_unusable_argument_is_named(call, error, says):
    with pytest.raises(error, match=says):
        call()


@pytest.mark.parametrize(
    "call",
    [
        lambda: pairs(threads=1025),
        lambda: pairs(threads=10**6),
        lambda: collision.World(threshold=0.1, threads=10**6),
        lambda: step().impacts(threads=10**6),
        lambda: satisfice.find(satisfice.problem("queens"), evaluations=10, threads=10**6),
    ],
)
def test_threads_have_the_limit_of_the_command(call):
    with pytest.raises(ValueError, match=r"threads = \d+ is not allowed: it must be a whole number from 0 \(all cores\) to 1024"):
        call()


def test_numbers_of_other_types_are_numbers():
    assert find(delta=Fraction(1, 10), evaluations=np.float64(20), time=np.array(30)).to_dict()["threshold"] == 0.1
    begun, tickets = asked()
    begun.tell(tickets, [Fraction(1, 100)])
    begun.inform(np.array([[0, 1]], dtype=object), True)
    assert begun.report().hits == 1
    mesh = collision.mesh(np.array(TRIANGLE[0], dtype=np.float32)[:, ::-1], np.array([[0, 1, 2]], dtype=np.uint8))
    assert len(collision.close_pairs(mesh, mesh, threshold=np.float32(0.5))) == 1
    unmasked = np.ma.array(TRIANGLE[0])
    assert len(collision.mesh(unmasked).vertices) == 3


def test_flags_axes_and_numbers_of_processes_have_types_of_numpy_too():
    parameters = find(integrality=np.array([1, 0]), periodic=(np.bool_(False), 1.0)).to_dict()["problem_parameters"]
    assert parameters["integrality"] == [True, False] and parameters["periodic"] == [False, True]
    parameters = find(categories={np.int64(1): np.array(["a", "b"])}).to_dict()["problem_parameters"]
    assert parameters["categories"] == {"1": ["a", "b"]}
    parameters = find(permutations=np.array([[0, 1]])).to_dict()["problem_parameters"]
    assert parameters["permutations"] == [[0, 1]]
    assert find(workers=np.int64(2)).to_dict()["budget"]["parallel"] == 2


def test_as_many_points_as_there_are_numbers_can_be_asked():
    assert len(search(evaluations=100).ask(10**8)) == 100
    endless = search(evaluations=None, time=60, engine="random")
    batch = endless.ask(10**8)
    assert len(batch) == 65_536 and len(endless.ask(10**8)) == 0
    endless.tell(batch.tickets, np.ones(len(batch)))
    assert len(endless.ask(1)) == 1


def test_what_is_no_real_number_is_no_value():
    square = [(-1, 1)] * 2
    limits = {"delta": 1, "separation": 0.1, "evaluations": 20, "seed": 1}
    for wrong in ["0.5", np.complex64(0.5j), np.complex128(0.5), 0.5j]:
        for workers in [1, map]:
            with pytest.raises(TypeError, match="one real number"):
                satisfice.find(lambda x: wrong, square, **limits, workers=workers)  # noqa: B023
    masked = satisfice.find(lambda x: np.ma.masked_array(np.zeros(len(x)), mask=True), square, **limits, vectorized=True)
    assert masked.hits == 0 and masked.non_finite > 0


def test_a_function_that_raises_stop_iteration_is_told():
    search = satisfice.Search([(-1, 1)] * 2, delta=1, evaluations=20)
    with pytest.raises(RuntimeError, match="raised StopIteration"):
        search.run(lambda x: next(iter([])))


def test_shapes_that_do_not_fit_are_told():
    search = satisfice.Search([(-1, 1)] * 2, delta=1, evaluations=20)
    with pytest.raises(ValueError, match=r"values have shape \(1, 1\)"):
        search.tell(search.ask(1).tickets, [[1.0]])
    with pytest.raises(ValueError, match="a tuple"):
        collision.mesh(list(TRIANGLE))
    with pytest.raises(ValueError, match="read a file first"):
        collision.mesh("bunny.obj")


def test_values_in_any_order_are_refused():
    with ThreadPool(2) as pool, pytest.raises(ValueError, match="pool.map"):
        satisfice.find(np.sum, [(-1, 1)] * 2, delta=1, evaluations=20, workers=pool.imap_unordered)


def test_a_table_without_hits_has_its_columns():
    pytest.importorskip("pandas")
    report = satisfice.find(lambda x: 1.0, [(-1, 1)] * 2, delta=0.5, evaluations=20)
    assert list(report.to_pandas().columns) == ["x0", "x1", "fun", "evaluation", "time"]
