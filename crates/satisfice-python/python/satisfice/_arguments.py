"""What is searched and how long, checked, as the native part takes it."""

from __future__ import annotations

import json
import math
import secrets
from collections.abc import Mapping, Sequence
from typing import Any

from ._axes import Axes, as_list, is_number
from ._checked import real, reals, seconds, whole, whole_or_none
from ._names import texts


def run_arguments(
    *,
    engine: str,
    options: Mapping[str, Any] | None,
    seed: int | None,
    time: float | None,
    evaluations: int | None,
    hits: int | None,
    patience: int | None,
    probes: float | None,
    islands: int,
    parallel: int | None,
    slices: int = 1,
    threads: int = 1,
) -> dict[str, Any]:
    """Engine, seed and budget, as the native part takes them."""
    if time is None and evaluations is None and patience is None:
        raise ValueError("nothing limits the search: give time= in seconds, evaluations= or patience=")
    return {
        "engine": engine,
        "options": texts(options or {}),
        "seed": secrets.randbits(32) if seed is None else whole("seed", seed, least=0),
        "time": seconds(time),
        "evaluations": whole_or_none("evaluations", evaluations),
        "hits": whole_or_none("hits", hits),
        "patience": whole_or_none("patience", patience),
        "slices": whole("slices", slices),
        "probes": None if probes is None else real("probes", probes),
        "islands": whole("islands", islands),
        "threads": whole("threads", threads, least=0),
        "parallel": whole_or_none("parallel", parallel),
    }


def question(
    name: str,
    bounds: Any,
    delta: float | None,
    separation: float | Sequence[float] | None,
    x0: Any,
    components: int | None,
    **kinds: Any,
) -> dict[str, Any]:
    """What is searched, as the native part takes it; `kinds` as for `Axes`."""
    if bounds is None:
        raise ValueError("bounds is missing: give (lower, upper) for each axis")
    if delta is None:
        raise ValueError("delta is missing: a hit is a point with f(x) < delta")
    delta = real("delta", delta)
    if math.isnan(delta):
        raise ValueError("delta is NaN: no value is below it")
    axes = Axes(bounds, **kinds)
    if separation is None:
        widths = None
    elif is_number(separation):
        # A radius says nothing about categories: different ones are different hits.
        radius = real("separation", separation)
        if not radius > 0:
            raise ValueError(f"separation = {radius} is not allowed: a positive number, or none for exact coordinates")
        widths = [0.0 if axis in axes.exact else radius for axis in range(len(axes))]
    else:
        widths = [real("separation", width) for width in as_list(separation)]
    parameters: dict[str, Any] = {"function": name, **axes.parameters()}
    if widths is not None:
        parameters["separation"] = widths
    starts = _starts(x0, len(axes))
    if starts:
        parameters["x0"] = starts
    if callable(components):
        raise TypeError("components is how many there are: let f return (value, components)")
    count = 0 if components is None else whole("components", components)
    if count:
        parameters["components"] = count
    return {
        "axes": axes.entries(),
        "delta": delta,
        "separation": widths,
        "components": count,
        "starts": starts,
        "name": "function",
        "parameters": json.dumps(parameters),
    }


def _starts(x0: Any, dimension: int) -> list[list[float]]:
    if x0 is None:
        return []
    points = reals("x0", x0)
    shape = points.shape
    points = points.reshape(1, -1) if points.ndim == 1 else points
    if points.ndim != 2 or points.shape[1] != dimension:
        raise ValueError(f"x0 has shape {shape}: give ({dimension},) for one point, or (m, {dimension})")
    starts: list[list[float]] = points.tolist()
    for index, start in enumerate(starts):
        if not all(map(math.isfinite, start)):
            raise ValueError(f"start point {index} is not finite: {start}")
    return starts
