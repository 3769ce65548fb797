"""Checkpoints that cannot be written: at the beginning an error, later a warning."""

import shutil
import warnings

import evaluations
import pytest
import satisfice
from satisfice import _files

SQUARE = [(-2, 2), (-2, 2)]
RING = {"delta": 0.05, "separation": 0.1, "evaluations": 200, "seed": 1}


class Vanishes:
    """The ring; at the 100th call the folder of the checkpoint goes, and at the 150th it may come again."""

    def __init__(self, folder, comes_again):
        self.folder, self.comes_again, self.calls = folder, comes_again, 0
        folder.mkdir(exist_ok=True)

    def __call__(self, x):
        self.calls += 1
        if self.calls == 100:
            shutil.rmtree(self.folder)
        if self.calls == 150 and self.comes_again:
            self.folder.mkdir()
        return evaluations.ring(x)


def test_a_folder_that_vanishes_is_a_warning(tmp_path):
    folder = tmp_path / "runs"
    with pytest.warns(RuntimeWarning) as told:
        report = satisfice.find(Vanishes(folder, False), SQUARE, **RING, checkpoint=folder / "run.json")
    assert report.evaluations == 200 and report.hits > 10
    first, end = (str(one.message) for one in told)
    assert "cannot write the search: No such file" in first and "run.json" in first and "goes on" in first
    assert "does not hold its end" in end and "run.json" in end


@pytest.mark.parametrize("comes_again", [False, True])
def test_later_writes_are_tried_again(tmp_path, monkeypatch, comes_again):
    monkeypatch.setattr(_files, "_FIRST", 0.0)
    monkeypatch.setattr(_files, "_EVERY", 0.0)
    monkeypatch.setattr(_files, "_TIMES", 0)
    file = tmp_path / "runs" / "run.json"
    search = satisfice.Search(SQUARE, **RING)
    with pytest.warns(RuntimeWarning) as told:
        report = search.run(Vanishes(file.parent, comes_again), checkpoint=file)
    assert report.evaluations == 200
    if comes_again:
        assert len(told) == 1 and satisfice.Search.load(file).report().evaluations == 200
    else:
        assert len(told) == 2 and not file.exists()


def test_islands_and_problems_go_on_too(tmp_path, monkeypatch):
    monkeypatch.setattr(_files, "_FIRST", 0.0)
    folder = tmp_path / "runs"
    folder.mkdir()

    def callback(progress):
        shutil.rmtree(folder, ignore_errors=True)

    options = {"callback": callback, "checkpoint": folder / "run.json", "seed": 1}
    with pytest.warns(RuntimeWarning, match="run.json") as told:
        report = satisfice.find(evaluations.ring, SQUARE, **{**RING, **options, "evaluations": 3000}, islands=2, executor=1)
    assert report.evaluations == 3000 and "does not hold its end" in str(told[-1].message)
    folder.mkdir()
    with pytest.warns(RuntimeWarning, match="run.json") as told:
        report = satisfice.find(satisfice.problem("queens", n=9), evaluations=200_000, engine="pso", **options)
    assert report.evaluations == 200_000 and "does not hold its end" in str(told[-1].message)


def test_the_first_write_fails_at_once_and_the_exception_has_the_report(tmp_path):
    file = tmp_path / "nowhere" / "run.json"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(FileNotFoundError, match="run.json") as raised:
            satisfice.Search(SQUARE, **RING).run(evaluations.ring, checkpoint=file)
        assert raised.value.report.evaluations < 10
        with pytest.raises(FileNotFoundError, match="run.json") as raised:
            satisfice.find(satisfice.problem("queens", n=9), evaluations=200_000, seed=1, checkpoint=file)
        assert raised.value.report.evaluations < 200_000


def test_an_exception_of_the_function_is_more_than_an_unwritten_file(tmp_path):
    folder = tmp_path / "runs"
    inner = Vanishes(folder, False)

    def fails(x):
        value = inner(x)
        if inner.calls == 120:
            raise ArithmeticError("diverged")
        return value

    for search in [
        lambda: satisfice.find(fails, SQUARE, **RING, checkpoint=folder / "run.json"),
        lambda: satisfice.Search(SQUARE, **RING).run(fails, checkpoint=folder / "run.json"),
    ]:
        inner.__init__(folder, False)
        with pytest.raises(ArithmeticError, match="diverged") as raised, pytest.warns(RuntimeWarning, match="run.json"):
            search()
        assert raised.value.report.evaluations == 119
