"""Distinct hits of satisfice beside pyribs, nevergrad, SciPy and optuna: at equal evaluations, and at equal seconds.

    pip install ./crates/satisfice-python scipy ribs nevergrad optuna
    python benches/python/compare.py --evaluations 5000 --seeds 5 > docs/results/python.md

Every tool is used as its documentation advises for many distinct solutions; the settings are below, beside their sources. Hits are
counted alike for all tools: points below delta, in the order found, that are farther than the separation from every hit before.
"""

from __future__ import annotations

import argparse
import platform
import time
import warnings
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np
import satisfice


@dataclass(frozen=True)
class Problem:
    """f(x) < delta in a box; hits within `separation` are one."""

    name: str
    f: object
    bounds: list
    delta: float
    separation: float


def himmelblau(x):
    return (x[0] ** 2 + x[1] - 11) ** 2 + (x[0] + x[1] ** 2 - 7) ** 2


def ring(x):
    return abs(np.hypot(x[0], x[1]) - 1.0)


def rastrigin(x):
    return float(10 * len(x) + np.sum(x * x - 10 * np.cos(2 * np.pi * x)))


def shubert(x):
    k = np.arange(1, 6)
    return float(np.prod([np.sum(k * np.cos((k + 1) * xi + k)) for xi in x]))


def vincent(x):
    return float(1 - np.mean(np.sin(10 * np.log(x))))


def arm(x):
    """A planar arm of six links of equal length that reaches a point."""
    angle = np.cumsum(x)
    return float(np.hypot(np.cos(angle).sum() / 6 - 0.5, np.sin(angle).sum() / 6 - 0.3))


PROBLEMS = [
    Problem("himmelblau, 4 roots", himmelblau, [(-5, 5)] * 2, 1e-2, 0.5),
    Problem("ring in 2 dimensions", ring, [(-2, 2)] * 2, 0.01, 0.1),
    Problem("rastrigin in 3 dimensions", rastrigin, [(-5.12, 5.12)] * 3, 8.0, 0.5),
    Problem("shubert, 18 optima", shubert, [(-10, 10)] * 2, -180.0, 0.5),
    Problem("vincent, 36 optima", vincent, [(0.25, 10)] * 2, 0.01, 0.2),
    Problem("arm of 6 links", arm, [(-np.pi, np.pi)] * 6, 0.02, 0.5),
]


class OverBudget(Exception):
    """The evaluations or the seconds are spent."""


class Counter:
    """Evaluates, counts, keeps the points below delta, and stops a tool at its budget."""

    def __init__(self, problem, evaluations, seconds):
        self.problem, self.evaluations = problem, evaluations
        self.end = time.perf_counter() + seconds
        self.calls, self.found = 0, []

    def __call__(self, x):
        if self.calls >= self.evaluations or time.perf_counter() >= self.end:
            raise OverBudget
        self.calls += 1
        x = np.asarray(x, dtype=float)
        value = float(self.problem.f(x))
        if value < self.problem.delta:
            self.found.append(x.copy())
        return value

    def distinct(self):
        hits = np.empty((0, len(self.problem.bounds)))
        for x in self.found:
            if len(hits) == 0 or np.linalg.norm(hits - x, axis=1).min() > self.problem.separation:
                hits = np.vstack([hits, x])
        return len(hits)


def by_satisfice(f, problem, evaluations, seconds, seed):
    satisfice.find(
        f, problem.bounds, delta=problem.delta, separation=problem.separation, evaluations=evaluations, time=seconds, seed=seed
    )


def by_random(f, problem, evaluations, seconds, seed):
    rng = np.random.default_rng(seed)
    low, high = np.array(problem.bounds).T
    while True:
        f(rng.uniform(low, high))


def by_scipy(f, problem, evaluations, seconds, seed):
    """Differential evolution, started again with another seed until the budget is spent: its answer is one point."""
    from scipy.optimize import differential_evolution

    run = 0
    while True:
        differential_evolution(f, problem.bounds, rng=np.random.default_rng([seed, run]), polish=False)
        run += 1


def by_ribs(f, problem, evaluations, seconds, seed):
    """CMA-ME: an archive over the first two coordinates, five improvement emitters (Fontaine et al. 2020; pyribs' tutorial)."""
    from ribs.archives import GridArchive
    from ribs.emitters import EvolutionStrategyEmitter
    from ribs.schedulers import Scheduler

    low, high = np.array(problem.bounds).T
    cells = [min(200, max(10, int((high[i] - low[i]) / problem.separation * 2))) for i in range(2)]
    archive = GridArchive(solution_dim=len(low), dims=cells, ranges=list(zip(low[:2], high[:2])))
    emitters = [
        EvolutionStrategyEmitter(
            archive, x0=(low + high) / 2, sigma0=float(np.mean(high - low)) / 4, ranker="2imp",
            bounds=list(zip(low, high)), batch_size=30, seed=1000 * seed + i,
        )
        for i in range(5)
    ]
    scheduler = Scheduler(archive, emitters)
    while True:
        x = scheduler.ask()
        scheduler.tell([-f(row) for row in x], x[:, :2])


def by_nevergrad(f, problem, evaluations, seconds, seed):
    """TwoPointsDE, which its documentation advises where many points are evaluated; its NGOpt fails with NumPy 2.4."""
    import nevergrad as ng

    low, high = np.array(problem.bounds).T
    space = ng.p.Array(init=(low + high) / 2).set_bounds(low, high)
    space.random_state.seed(seed)
    optimizer = ng.optimizers.TwoPointsDE(parametrization=space, budget=evaluations, num_workers=1)
    while True:
        candidate = optimizer.ask()
        optimizer.tell(candidate, f(candidate.value))


def by_optuna(f, problem, evaluations, seconds, seed):
    """TPE, the default sampler."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))
    study.optimize(lambda trial: f([trial.suggest_float(f"x{i}", *ends) for i, ends in enumerate(problem.bounds)]))


TOOLS = {
    "satisfice": by_satisfice,
    "pyribs": by_ribs,
    "nevergrad": by_nevergrad,
    "scipy": by_scipy,
    "optuna": by_optuna,
    "uniform": by_random,
}
PACKAGES = {"satisfice": "satisfice", "pyribs": "ribs", "nevergrad": "nevergrad", "scipy": "scipy", "optuna": "optuna"}


def hits(tool, problem, evaluations, seconds, seed):
    counter = Counter(problem, evaluations, seconds)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            tool(counter, problem, evaluations, seconds, seed)
        except OverBudget:
            pass
    return counter.distinct(), counter.calls


def table(evaluations, seconds, seeds):
    print("| problem | " + " | ".join(TOOLS) + " |")
    print("|---" * (len(TOOLS) + 1) + "|")
    for problem in PROBLEMS:
        cells = []
        for tool in TOOLS.values():
            runs = [hits(tool, problem, evaluations, seconds, seed) for seed in range(seeds)]
            found, calls = np.median(runs, axis=0)
            cells.append(f"{found:.0f}" if calls >= evaluations else f"{found:.0f} ({calls:,.0f})")
        print(f"| {problem.name} | " + " | ".join(cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--evaluations", type=int, default=5000)
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--most", type=float, default=20.0, help="seconds after which a tool is stopped at equal evaluations")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--only", choices=["evaluations", "seconds"], help="one of the two tables")
    arguments = parser.parse_args()
    versions = ", ".join(f"{tool} {version(package)}" for tool, package in PACKAGES.items())
    print("# Beside other tools of Python\n")
    print("By `benches/python/compare.py`, which says how each tool is used. Medians of distinct hits over", arguments.seeds, "seeds.")
    print(f"Python {platform.python_version()}; {versions}.\n")
    for tool in TOOLS.values():  # what is imported or compiled at the first use is no part of a search
        hits(tool, PROBLEMS[0], 200, 30.0, 0)
    if arguments.only != "seconds":
        print(f"## At {arguments.evaluations:,} evaluations\n")
        print(
            f"In parentheses: the calls of f, where they are fewer. A tool was stopped after {arguments.most:g} s; satisfice counts a point of a "
            "known hit as an evaluation without calling f.\n"
        )
        table(arguments.evaluations, arguments.most, arguments.seeds)
    if arguments.only != "evaluations":
        print(f"\n## In {arguments.seconds:g} s\n\nIn parentheses: the calls of f.\n")
        table(10**9, arguments.seconds, arguments.seeds)


if __name__ == "__main__":
    main()
