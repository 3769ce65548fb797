"""Distinct hits and coverage of the engine `surrogate` beside BoTorch's constraint active search, at equal evaluations.

    pip install ./crates/satisfice-python botorch
    python benches/python/constraint_active_search.py --evaluations 50 100 --seeds 4

Constraint active search maximises the expected coverage improvement (Malkomes et al. 2021, ICML): how much of the feasible set a
ball around the next point is expected to cover that no ball around an earlier point covers. BoTorch publishes it as a tutorial,
not as a function. It is written here after the paper, with the tutorial's settings: an independent Gaussian process, 512 points in a ball,
smooth edges of 0.002, 10 restarts from 512 raw points, 5 scrambled Sobol points first. Its radius is the problem's separation. A run of 50
evaluations takes about 20 seconds, one of 200 about five minutes.

All problems are scaled to the unit cube. Hits are counted alike for both: points below delta, in the order found, farther than the
separation from every hit before. Coverage is the share of 2,000 random feasible points within the separation of an evaluated hit.
"""

from __future__ import annotations

import argparse
import time
import warnings
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np
import satisfice
import torch
from botorch.acquisition import AcquisitionFunction
from botorch.fit import fit_gpytorch_mll
from botorch.models import SingleTaskGP
from botorch.models.transforms.outcome import Standardize
from botorch.optim import optimize_acqf
from botorch.utils.sampling import sample_hypersphere
from botorch.utils.transforms import t_batch_mode_transform
from gpytorch.constraints import Interval
from gpytorch.likelihoods import GaussianLikelihood
from gpytorch.mlls import ExactMarginalLogLikelihood
from torch.quasirandom import SobolEngine

FEASIBLE = 0.01
FIRST, BALL, EDGE, RESTARTS, RAW = 5, 512, 2e-3, 10, 512


@dataclass(frozen=True)
class Problem:
    """low < value(x) < high in the unit cube; hits within `separation` are one."""

    name: str
    value: object
    axes: int
    low: float
    high: float
    separation: float


def tutorial(x):
    return np.exp(-2 * (x[..., 0] - 0.3) ** 2 - 4 * (x[..., 1] - 0.6) ** 2)


def branin(x):
    u, v = 15 * x[..., 0] - 5, 15 * x[..., 1]
    valley = v - 5.1 / (4 * np.pi**2) * u**2 + 5 / np.pi * u - 6
    return valley**2 + 10 * (1 - 1 / (8 * np.pi)) * np.cos(u) + 10


def himmelblau(x):
    u, v = 12 * x[..., 0] - 6, 12 * x[..., 1] - 6
    return np.log1p((u**2 + v - 11) ** 2 + (u + v**2 - 7) ** 2)


def rosenbrock(x):
    u = 4 * x - 2
    return np.log1p(np.sum(100 * (u[..., 1:] - u[..., :-1] ** 2) ** 2 + (1 - u[..., :-1]) ** 2, axis=-1))


def hartmann(x):
    c = np.array([1.0, 1.2, 3.0, 3.2])
    a = np.array([[10, 3, 17, 3.5, 1.7, 8], [0.05, 10, 17, 0.1, 8, 14], [3, 3.5, 1.7, 10, 17, 8], [17, 8, 0.05, 10, 0.1, 14]])
    p = 1e-4 * np.array(
        [
            [1312, 1696, 5569, 124, 8283, 5886],
            [2329, 4135, 8307, 3736, 1004, 9991],
            [2348, 1451, 3522, 2883, 3047, 6650],
            [4047, 8828, 8732, 5743, 1091, 381],
        ]
    )
    return -np.sum(c * np.exp(-np.sum(a * (x[..., None, :] - p) ** 2, axis=-1)), axis=-1)


def best_hundredth(name, value, axes, separation):
    """The points with the lowest hundredth of the values."""
    samples = value(np.random.default_rng(7).uniform(size=(100_000, axes)))
    return Problem(name, value, axes, -np.inf, float(np.quantile(samples, FEASIBLE)), separation)


PROBLEMS = [
    Problem("BoTorch's example", tutorial, 2, 0.55, 0.75, 0.1),
    best_hundredth("Branin", branin, 2, 0.01),
    best_hundredth("Himmelblau (log1p)", himmelblau, 2, 0.01),
    best_hundredth("Rosenbrock (log1p), 4 axes", rosenbrock, 4, 0.03),
    best_hundredth("Hartmann, 6 axes", hartmann, 6, 0.05),
]


class Coverage(AcquisitionFunction):
    """Expected coverage improvement of one point.

    It needs the variance of each point of a ball only. `model.posterior` also works out its covariance with the rest of the ball, which
    takes eight times as long, so the posterior is written out here. `agrees` compares both.
    """

    def __init__(self, model, problem, known):
        super().__init__(model)
        self.problem, self.known = problem, known
        directions = sample_hypersphere(d=problem.axes, n=BALL, qmc=True, dtype=torch.double)
        lengths = torch.rand(BALL, 1, dtype=torch.double) ** (1 / problem.axes)
        self.ball = problem.separation * lengths * directions
        model.eval()
        with torch.no_grad():
            kernel = model.covar_module(known).to_dense()
            noise = model.likelihood.noise * torch.eye(len(known), dtype=torch.double)
            self.inverse = torch.cholesky_inverse(torch.linalg.cholesky(kernel + noise))
            self.mean = model.mean_module(known)[0]
            self.weights = self.inverse @ (model.train_targets - self.mean)
            self.amplitude = kernel[0, 0]
        # The model's values are standardised.
        self.shift, self.scale = model.outcome_transform.means.squeeze(), model.outcome_transform.stdvs.squeeze()
        limits = (torch.tensor(limit, dtype=torch.double) for limit in (problem.low, problem.high))
        self.low, self.high = ((limit - self.shift) / self.scale for limit in limits)

    def predict(self, points):
        """Means and deviations of standardised values."""
        kernel = self.model.covar_module(points, self.known).to_dense()
        variance = self.amplitude - ((kernel @ self.inverse) * kernel).sum(dim=-1)
        return self.mean + kernel @ self.weights, variance.clamp_min(1e-12).sqrt()

    def agrees(self):
        """Whether predictions are those of `model.posterior`."""
        with torch.no_grad():
            generator = torch.Generator().manual_seed(0)  # the search's random numbers stay as they are
            points = torch.rand(64, self.problem.axes, dtype=torch.double, generator=generator)
            mean, deviation = self.predict(points)
            posterior = self.model.posterior(points)
            means = torch.allclose(self.shift + self.scale * mean, posterior.mean.squeeze(-1), rtol=1e-4, atol=1e-6)
            deviations = self.scale * deviation, posterior.variance.sqrt().squeeze(-1)
            return means and torch.allclose(*deviations, rtol=1e-2, atol=1e-3 * float(self.scale))

    @t_batch_mode_transform(expected_q=1)
    def forward(self, x):
        points = self.ball + x
        inside = (torch.sigmoid(points / EDGE) - torch.sigmoid((points - 1) / EDGE)).prod(dim=-1)
        uncovered = torch.sigmoid((torch.cdist(points, self.known) - self.problem.separation) / EDGE).prod(dim=-1)
        mean, deviation = self.predict(points.reshape(-1, self.problem.axes))
        normal = torch.distributions.Normal(mean, deviation, validate_args=False)
        feasible = normal.cdf(self.high)
        if torch.isfinite(self.low):
            feasible = feasible - normal.cdf(self.low)
        return (feasible.reshape(inside.shape) * inside * uncovered).sum(dim=-1) / inside.sum(dim=-1)


def by_botorch(problem, evaluations, seed):
    torch.manual_seed(seed)
    x = SobolEngine(problem.axes, scramble=True, seed=seed).draw(FIRST).double()
    bounds = torch.tensor([[0.0] * problem.axes, [1.0] * problem.axes], dtype=torch.double)
    while len(x) < evaluations:
        y = torch.as_tensor(problem.value(x.numpy())).unsqueeze(-1)
        likelihood = GaussianLikelihood(noise_constraint=Interval(1e-6, 1e-3))
        model = SingleTaskGP(x, y, likelihood=likelihood, outcome_transform=Standardize(m=1))
        fit_gpytorch_mll(ExactMarginalLogLikelihood(model.likelihood, model))
        coverage = Coverage(model, problem, x)
        if not coverage.agrees():
            raise AssertionError("the posterior written out is not that of BoTorch")
        best, _ = optimize_acqf(coverage, bounds=bounds, q=1, num_restarts=RESTARTS, raw_samples=RAW)
        x = torch.cat((x, best.detach()))
    return x.numpy()


def by_satisfice(problem, evaluations, seed):
    points = []

    def f(x):
        points.append(np.array(x, dtype=float))
        value = float(problem.value(points[-1]))
        return max(value - problem.high, problem.low - value)

    satisfice.find(
        f, [(0.0, 1.0)] * problem.axes, delta=0.0, separation=problem.separation,
        evaluations=evaluations, seed=seed, engine="surrogate",
    )
    return np.array(points)


def is_hit(problem, x):
    value = problem.value(x)
    return (value > problem.low) & (value < problem.high)


def distinct(problem, points):
    hits = np.empty((0, problem.axes))
    for x in points[is_hit(problem, points)]:
        if len(hits) == 0 or np.linalg.norm(hits - x, axis=1).min() > problem.separation:
            hits = np.vstack([hits, x])
    return len(hits)


def feasible_points(problem, count=2000):
    rng, found = np.random.default_rng(11), np.empty((0, problem.axes))
    while len(found) < count:
        x = rng.uniform(size=(100_000, problem.axes))
        found = np.vstack([found, x[is_hit(problem, x)]])
    return found[:count]


def covered(problem, points, feasible):
    hits = points[is_hit(problem, points)]
    if len(hits) == 0:
        return 0.0
    return float(np.mean([np.linalg.norm(hits - x, axis=1).min() <= problem.separation for x in feasible]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--evaluations", type=int, nargs="+", default=[50, 200])
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--only", default="", help="part of a problem's name")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    print(f"satisfice {version('satisfice')}, botorch {version('botorch')}, torch {torch.__version__}, {arguments.seeds} seeds\n")
    print("| problem | evaluations | hits: surrogate / BoTorch | coverage: surrogate / BoTorch | seconds a run: surrogate / BoTorch |")
    print("|---|---|---|---|---|")
    for problem in PROBLEMS:
        if arguments.only not in problem.name:
            continue
        feasible = feasible_points(problem)
        runs = {}
        for name, tool in (("surrogate", by_satisfice), ("botorch", by_botorch)):
            start = time.perf_counter()
            runs[name] = [tool(problem, max(arguments.evaluations), seed) for seed in range(arguments.seeds)]
            runs[name, "seconds"] = (time.perf_counter() - start) / arguments.seeds
        for evaluations in arguments.evaluations:
            cells = []
            for measure in (
                lambda x: f"{np.mean([distinct(problem, points[:evaluations]) for points in x]):.1f}",
                lambda x: f"{100 * np.mean([covered(problem, points[:evaluations], feasible) for points in x]):.0f} %",
            ):
                cells.append(" / ".join(measure(runs[name]) for name in ("surrogate", "botorch")))
            cells.append(" / ".join(f"{runs[name, 'seconds']:.1f}" for name in ("surrogate", "botorch")))
            print(f"| {problem.name} | {evaluations} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
