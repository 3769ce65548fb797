"""The recipe for HyperQueue in docs/python/cluster.md, with a server and a worker on this machine."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import command, without_times

HQ = shutil.which("hq") or shutil.which("hq", path=str(Path(sys.executable).parent))
SUITE = """
seeds = [1, 2]
budget = { evaluations = 300 }
[[problem]]
name = "queens"
n = 6
[[engine]]
name = "random"
[[engine]]
name = "pso"
"""


@pytest.mark.skipif(HQ is None, reason="HyperQueue is not installed (pip install hyperqueue)")
def test_a_sweep_in_shards_on_hyperqueue(tmp_path):
    environment = {**os.environ, "HQ_SERVER_DIR": str(tmp_path / "hq"), "PYTHON": sys.executable}
    (tmp_path / "mine.toml").write_text(SUITE)

    def hq(*arguments, start=False):
        run = subprocess.Popen if start else subprocess.run
        options = {} if start else {"check": True, "timeout": 60}
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL} if start else {"capture_output": True, "text": True}
        return run([HQ, *arguments], cwd=tmp_path, env=environment, **quiet, **options)

    server = hq("server", "start", "--host", "127.0.0.1", start=True)
    worker = None
    try:
        hq("server", "wait", "--timeout", "30s")
        worker = hq("worker", "start", "--cpus", "2", start=True)
        job = '"$PYTHON" -m satisfice bench mine.toml --shard "$HQ_TASK_ID/2" --out "shard-$HQ_TASK_ID"'
        hq("submit", "--array", "1-2", "--wait", "sh", "-c", job)
    finally:
        for process in (worker, server):
            if process is not None:
                process.terminate()
                process.wait()
    shards = sorted(str(path) for path in tmp_path.glob("shard-*"))
    assert len(shards) == 2
    merged = command("bench", "merge", *shards, "--out", tmp_path / "merged")
    assert merged.returncode == 0, merged.stderr
    whole = command("bench", tmp_path / "mine.toml", "--out", tmp_path / "whole")
    assert whole.returncode == 0, whole.stderr

    def runs(folder):
        lines = [line for path in sorted(Path(folder).glob("*.jsonl")) for line in path.read_text().splitlines()]
        return sorted(json.dumps(without_times(line), sort_keys=True) for line in lines)

    assert len(runs(tmp_path / "merged")) == 4 and runs(tmp_path / "merged") == runs(tmp_path / "whole")
