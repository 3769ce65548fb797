"""The recipe for HyperQueue in docs/python/cluster.md, with a server and a worker on this machine."""

import json
import sys
from pathlib import Path

import pytest
from conftest import command

SUITE = """
title = "Mine"
seeds = "0..2"

[[part]]
name = "queens"
engines = ["random", "pso"]
problems = [{ name = "queens", n = 6 }]
evaluations = 300
"""


def runs(folder):
    """Engine, seed and counts of each run, in any order."""
    lines = (Path(folder) / "results.jsonl").read_text().splitlines()
    reports = [json.loads(line) for line in lines]
    return sorted((report["engine"], report["seed"], report["evaluations"], report["hits"]) for report in reports)


def test_a_sweep_in_shards(tmp_path):
    hyperqueue = pytest.importorskip("hyperqueue")
    from hyperqueue.cluster import LocalCluster, WorkerConfig

    (tmp_path / "mine.toml").write_text(SUITE)
    job = hyperqueue.Job(default_workdir=tmp_path)
    for shard in (1, 2):
        job.program(
            [sys.executable, "-m", "satisfice", "bench", "mine.toml", "--shard", f"{shard}/2", "--out", f"shard-{shard}"]
        )
    with LocalCluster(server_dir=str(tmp_path / "hq"), worker_config=WorkerConfig(cores=2)) as cluster:
        client = cluster.client()
        assert client.wait_for_jobs([client.submit(job)])
    merged = command("bench", "merge", tmp_path / "shard-1", tmp_path / "shard-2", "--out", tmp_path / "merged")
    assert merged.returncode == 0, merged.stderr
    assert [run[:3] for run in runs(tmp_path / "merged")] == [(engine, seed, 300) for engine in ("pso", "random") for seed in (0, 1)]
    assert runs(tmp_path / "merged") == sorted(runs(tmp_path / "shard-1") + runs(tmp_path / "shard-2"))
