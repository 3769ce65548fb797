"""`Search.save` and `checkpoint=`: where they write, and what is left of a failure."""

import os
import stat
import threading

import pytest
import satisfice

SQUARE = [(-1, 1)] * 2


def search():
    return satisfice.Search(SQUARE, delta=0.1, separation=0.1, evaluations=20, seed=1)


def test_a_link_is_written_through(tmp_path):
    (tmp_path / "far").mkdir()
    target, link = tmp_path / "far" / "search.json", tmp_path / "link.json"
    target.write_text("old")
    target.chmod(0o640)
    link.symlink_to(os.path.join("far", "search.json"))
    search().save(link)
    assert link.is_symlink() and satisfice.Search.load(target).hits == 0
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    target.unlink()
    search().save(link)
    assert link.is_symlink() and target.is_file()
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["far", "link.json", "search.json"]


def test_a_device_and_a_pipe_are_written_in_place(tmp_path):
    null = tmp_path / "null"
    null.symlink_to(os.devnull)
    search().save(null)
    assert null.is_symlink() and not os.path.isfile(os.devnull)
    report = satisfice.find(lambda x: 1.0, SQUARE, delta=0.1, evaluations=20, seed=1, checkpoint=null)
    assert report.evaluations == 20

    pipe, heard = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: heard.append(pipe.read_bytes()))
    reader.start()
    search().save(pipe)
    reader.join(10)
    assert stat.S_ISFIFO(pipe.stat().st_mode) and len(heard[0]) > 100


@pytest.mark.parametrize("name", ["folder", "missing/search.json", "search.json/no", "x" * 300])
def test_a_place_that_cannot_be_written_is_named(tmp_path, name):
    (tmp_path / "folder").mkdir()
    (tmp_path / "search.json").write_text("old")
    path = tmp_path / name
    with pytest.raises(OSError) as raised:
        search().save(path)
    assert raised.value.filename == str(path) and "partial" not in str(raised.value)
    assert "cannot write the search" in str(raised.value)
    assert sorted(os.listdir(tmp_path)) == ["folder", "search.json"]


def test_a_folder_is_no_file(tmp_path):
    with pytest.raises(IsADirectoryError, match="it is a folder: name a file in it"):
        search().save(tmp_path)
    with pytest.raises(IsADirectoryError, match="it is a folder: name a file in it"):
        satisfice.find(lambda x: 1.0, SQUARE, delta=0.1, evaluations=20, checkpoint=tmp_path)


def test_a_failure_leaves_the_file_as_it_was(tmp_path, monkeypatch):
    path = tmp_path / "search.json"
    search().save(path)
    whole = path.read_bytes()

    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left") as raised:
        search().save(path)
    assert raised.value.filename == str(path)
    assert os.listdir(tmp_path) == ["search.json"] and path.read_bytes() == whole
