"""The catalogue, reports, and the command."""

import json
import pickle
import subprocess
import sys

import numpy as np
import pytest
import satisfice
from conftest import command, without_times


@pytest.mark.parametrize(
    ("name", "parameters", "options"),
    [
        ("queens", {"n": 6}, {"evaluations": 20_000}),
        ("rastrigin", {"dimension": 2}, {"evaluations": 5000, "engine": "latest-hit-qpso", "options": {"particles": 30}}),
        ("himmelblau", {}, {"evaluations": 1500, "probes": 0.1, "islands": 3}),
        ("shell", {}, {"evaluations": 3000, "slices": 2, "hits": 2000, "threads": 2}),
    ],
)
def test_the_report_is_that_of_the_command(name, parameters, options):
    report = satisfice.find(satisfice.problem(name, **parameters), seed=7, reference=True, **options)
    arguments = [f"--set={key}={value}" for key, value in parameters.items()]
    arguments += [f"--engine-set={key}={value}" for key, value in options.pop("options", {}).items()]
    arguments += [f"--{key}={value}" for key, value in options.items()]
    written = command("run", name, *arguments, "--seed=7", "--reference", "--json=-")
    assert written.returncode == 0, written.stderr
    assert without_times(report.to_json()) == without_times(written.stdout)
    # The layout is the same, too: only numbers of seconds differ.
    plain = [[line for line in text.splitlines() if "seconds" not in line] for text in (report.to_json(), written.stdout)]
    assert plain[0] == plain[1]


def test_a_report_comes_back_from_json_and_pickle(tmp_path, circle):
    report = satisfice.find(circle, [(-2, 2)] * 2, delta=0.01, evaluations=3000, seed=1)
    report.to_json(tmp_path / "report.json")
    text = (tmp_path / "report.json").read_text()
    for again in (satisfice.Report.from_json(text), pickle.loads(pickle.dumps(report))):
        assert again.to_json() == report.to_json() == text
        assert np.array_equal(again.x, report.x) and np.array_equal(again.fun, report.fun)
    with pytest.raises(ValueError, match="not the JSON of a report"):
        satisfice.Report.from_json("{}")


def test_a_report_of_the_command_is_read(tmp_path):
    assert command("run", "queens", "--evaluations=20000", "--json", tmp_path / "r.json").returncode == 0
    report = satisfice.Report.from_json((tmp_path / "r.json").read_text())
    assert report.problem == "queens" and report.hits == len(report.x)
    verified = command("verify", tmp_path / "r.json")
    assert verified.returncode == 0 and "is true" in verified.stdout


def test_the_catalogue_is_listed():
    listing = json.loads(command("list", "--json").stdout)
    assert list(satisfice.engines()) == [engine["name"] for engine in listing["engines"]]
    assert list(satisfice.problems()) == [problem["name"] for problem in listing["problems"]]
    assert satisfice.engines()["pso"].parameters["particles"].kind == "integer"
    common = {row["name"] for row in listing["common_engine_parameters"]}
    assert common and common <= set(satisfice.engines()["random"].parameters)


def test_problems_are_built_and_refused():
    problem = satisfice.problem("queens", n=6)
    assert problem.name == "queens" and problem.reference_hits() == 4
    again = pickle.loads(pickle.dumps(problem))
    assert satisfice.find(again, evaluations=5000, seed=1).hits == satisfice.find(problem, evaluations=5000, seed=1).hits
    for name, parameters, says in [("qeens", {}, "did you mean `queens`"), ("queens", {"m": 3}, "parameter of `queens`"), ("queens", {"n": -1}, "n = -1")]:
        with pytest.raises(ValueError, match=says):
            satisfice.problem(name, **parameters)
    for options, says in [({"delta": 1}, "delta does not apply"), ({"vectorized": True}, "vectorized does not apply")]:
        with pytest.raises(ValueError, match=says):
            satisfice.find(problem, evaluations=10, **options)


def test_solutions_that_are_no_points():
    report = satisfice.find(satisfice.problem("teapots"), evaluations=2000, seed=1)
    assert isinstance(report.solutions, list) and len(report.solutions) == report.hits


def test_a_report_shows_itself(circle):
    report = satisfice.find(circle, [(-2, 2)] * 2, delta=0.01, evaluations=500, seed=1)
    assert "500 evaluations" in repr(report) and "seed 1" in repr(report)
    assert report.trace["evaluations"][-1] == 500 and report.trace["hits"][-1] == report.hits


def test_pandas(circle):
    pandas = pytest.importorskip("pandas")
    report = satisfice.find(circle, [(-2, 2)] * 2, delta=0.01, evaluations=2000, seed=1)
    frame = report.to_pandas()
    assert list(frame.columns) == ["x0", "x1", "fun", "evaluation", "time"] and len(frame) == report.hits
    assert isinstance(frame, pandas.DataFrame) and np.array_equal(frame[["x0", "x1"]].to_numpy(), report.x)


def test_without_pandas_the_error_says_what_to_do(circle, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="pip install pandas"):
        satisfice.find(circle, [(-2, 2)] * 2, delta=0.01, evaluations=50, seed=1).to_pandas()


def test_the_command_reports_errors():
    for arguments, code, says in [
        (["run", "qeens"], 2, "did you mean"),
        (["bogus"], 2, "known: list, run"),
        (["run", "queens", "--evaluations=1", "--seed=1"], 1, ""),
    ]:
        done = command(*arguments)
        assert done.returncode == code and says in done.stderr, done.stderr
    assert command("--version").stdout.split() == ["satisfice", satisfice.__version__]


def test_the_examples_of_the_docstrings():
    import doctest
    import importlib

    for name in ("satisfice", "satisfice._find", "satisfice._names", "satisfice.collision"):
        result = doctest.testmod(importlib.import_module(name))
        assert result.failed == 0 and result.attempted > 0


def test_it_works_after_fork_and_under_spawn():
    program = """
import multiprocessing as mp, satisfice
def run(seed):
    return satisfice.find(satisfice.problem("queens", n=6), evaluations=3000, seed=seed, threads=2).hits
if __name__ == "__main__":
    here = [run(s) for s in range(3)]
    for method in ("fork", "spawn"):
        with mp.get_context(method).Pool(2) as pool:
            assert pool.map(run, range(3)) == here
"""
    with open("/dev/null") as nothing:
        import tempfile

        with tempfile.NamedTemporaryFile("w", suffix=".py") as file:
            file.write(program)
            file.flush()
            done = subprocess.run([sys.executable, file.name], stdin=nothing, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
