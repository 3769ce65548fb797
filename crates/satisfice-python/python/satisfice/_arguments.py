"""What is searched and how long, checked, as the native part takes it."""

from __future__ import annotations

import json
import math
import secrets
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._names import texts

_MOST = 2.0**53


def run_arguments(
    engine: str,
    options: Mapping[str, Any] | None,
    seed: int | None,
    time: float | None,
    evaluations: int | None,
    hits: int | None,
    slices: int,
    probes: float | None,
    islands: int,
    threads: int,
    parallel: int | None,
) -> dict[str, Any]:
    """Engine, seed and budget, as the native part takes them."""
    if time is None and evaluations is None:
        raise ValueError("nothing limits the search: give time= in seconds or evaluations=")
    return {
        "engine": engine,
        "options": texts(options or {}),
        "seed": secrets.randbits(32) if seed is None else _whole("seed", seed, least=0),
        "time": None if time is None else _real("time", time),
        "evaluations": None if evaluations is None else _whole("evaluations", evaluations),
        "hits": None if hits is None else _whole("hits", hits),
        "slices": _whole("slices", slices),
        "probes": None if probes is None else _real("probes", probes),
        "islands": _whole("islands", islands),
        "threads": _whole("threads", threads, least=0),
        "parallel": None if parallel is None else _whole("parallel", parallel),
    }


def question(
    name: str,
    bounds: Any,
    delta: float | None,
    separation: float | Sequence[float] | None,
    integrality: Any,
    categories: Mapping[int, Sequence[Any]] | None,
    x0: Any,
) -> dict[str, Any]:
    """What is searched, as the native part takes it."""
    if bounds is None:
        raise ValueError("bounds is missing: give (lower, upper) for each axis")
    if delta is None:
        raise ValueError("delta is missing: a hit is a point with f(x) < delta")
    if math.isnan(delta):
        raise ValueError("delta is NaN: no value is below it")
    axes, labels = _axes(bounds, integrality, dict(categories or {}))
    if separation is None:
        widths = None
    elif _is_number(separation):
        # A radius says nothing about categories: different ones are different hits.
        radius = _real("separation", separation)
        if not radius > 0:
            raise ValueError(f"separation = {radius} is not allowed: a positive number, or none for exact coordinates")
        widths = [0.0 if axis in labels else radius for axis in range(len(axes))]
    else:
        widths = [float(width) for width in _list(separation)]
    parameters: dict[str, Any] = {"function": name, "bounds": [list(axis[:2]) for axis in axes]}
    if any(axis[2] for axis in axes):
        parameters["integrality"] = [axis[2] for axis in axes]
    if labels:
        parameters["categories"] = {str(axis): [str(label) for label in words] for axis, words in labels.items()}
    if widths is not None:
        parameters["separation"] = widths
    starts = _starts(x0, len(axes))
    if starts:
        parameters["x0"] = starts
    return {
        "axes": axes,
        "delta": float(delta),
        "separation": widths,
        "starts": starts,
        "name": "function",
        "parameters": json.dumps(parameters),
    }


def _starts(x0: Any, dimension: int) -> list[list[float]]:
    if x0 is None:
        return []
    points = np.asarray(x0, dtype=np.float64)
    shape = points.shape
    points = points.reshape(1, -1) if points.ndim == 1 else points
    if points.ndim != 2 or points.shape[1] != dimension:
        raise ValueError(f"x0 has shape {shape}: give ({dimension},) for one point, or (m, {dimension})")
    starts: list[list[float]] = points.tolist()
    for index, start in enumerate(starts):
        if not all(map(math.isfinite, start)):
            raise ValueError(f"start point {index} is not finite: {start}")
    return starts


def _axes(
    bounds: Any, integrality: Any, categories: dict[int, Sequence[Any]]
) -> tuple[list[tuple[float, float, bool]], dict[int, list[Any]]]:
    if hasattr(bounds, "lb") and hasattr(bounds, "ub"):  # scipy.optimize.Bounds
        lower, upper = _list(bounds.lb), _list(bounds.ub)
        count = max(len(lower), len(upper))
        if not {len(lower), len(upper)} <= {1, count}:
            raise ValueError(f"bounds has {len(lower)} lower and {len(upper)} upper ends: give as many of both")
        lower, upper = (ends * count if len(ends) == 1 else ends for ends in (lower, upper))
        pairs: list[Any] = list(zip(lower, upper, strict=True))
    else:
        pairs = list(bounds)
    if integrality is None:
        whole = [False] * len(pairs)
    else:
        whole = [bool(value) for value in _list(integrality)]
        whole = whole * len(pairs) if _is_number(integrality) else whole
        if len(whole) != len(pairs):
            raise ValueError(f"integrality has {len(whole)} entries for {len(pairs)} axes")
    labels = {}
    for axis, words in categories.items():
        if not 0 <= axis < len(pairs):
            raise ValueError(f"categories names axis {axis}, but the axes are 0 to {len(pairs) - 1}")
        labels[axis] = list(words)
        if not labels[axis]:
            raise ValueError(f"axis {axis} has no category: give at least one label")
        pairs[axis], whole[axis] = (0, len(labels[axis]) - 1), True
    axes = []
    for axis, (pair, is_whole) in enumerate(zip(pairs, whole, strict=True)):
        try:
            low, high = (float(end) for end in pair)
        except (TypeError, ValueError):
            raise ValueError(f"bounds of axis {axis} are {pair!r}: give (lower, upper)") from None
        if is_whole and not (_is_whole(low) and _is_whole(high)):
            raise ValueError(f"bounds of axis {axis} are {pair!r}: an integer axis has whole ends below 2**53")
        axes.append((low, high, is_whole))
    return axes, labels


def _is_whole(number: float) -> bool:
    return abs(number) < _MOST and number == math.floor(number)


def _is_number(value: Any) -> bool:
    if hasattr(value, "ndim"):
        return bool(value.ndim == 0)
    return not hasattr(value, "__len__")


def _list(value: Any) -> list[Any]:
    if _is_number(value):
        return [value]
    return list(value)


def _real(name: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be a number, not {value!r}") from None


def _whole(name: str, value: Any, least: int = 1) -> int:
    if isinstance(value, float) and value.is_integer():
        value = int(value)  # 1e6
    try:
        number = value.__index__()
    except AttributeError:
        raise TypeError(f"{name} must be a whole number, not {value!r}") from None
    if not least <= number < 2**64:
        raise ValueError(f"{name} = {number} is not allowed: a whole number from {least} to 2**64 - 1")
    return int(number)
