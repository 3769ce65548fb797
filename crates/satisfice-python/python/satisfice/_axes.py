"""The axes of a space: bounds and what kind each of them is."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ._checked import real, whole

_MOST = 2.0**53


class Axes:
    """Axes, checked, as the native part and a report take them.

    Attributes
    ----------
    ends : list of (float, float)
        Least and greatest value of each axis.
    exact : set of int
        The axes on which different values are never one hit: categories and places of permutations.
    """

    def __init__(
        self,
        bounds: Any,
        *,
        integrality: Any = None,
        logarithmic: Any = None,
        periodic: Any = None,
        categories: Mapping[int, Sequence[Any]] | None = None,
        permutations: Sequence[Sequence[int]] | None = None,
    ) -> None:
        pairs = _pairs(bounds)
        self._flags = {
            "integer": _flags("integrality", integrality, len(pairs)),
            "logarithmic": _flags("logarithmic", logarithmic, len(pairs)),
            "periodic": _flags("periodic", periodic, len(pairs)),
        }
        self._labels: dict[int, list[Any]] = {}
        self._places: dict[int, list[int]] = {}
        for axis, labels in _categories(categories):
            self._take("categories", axis, pairs)
            self._labels[axis] = labels
            if not self._labels[axis]:
                raise ValueError(f"axis {axis} has no category: give at least one label")
            pairs[axis] = (0, len(self._labels[axis]) - 1)
        for group in _groups(permutations):
            self._take_permutation(group, pairs)
        self.exact = {*self._labels, *(axis for group in self._places.values() for axis in group)}
        self.ends = [self._ends(axis, pair) for axis, pair in enumerate(pairs)]

    def __len__(self) -> int:
        return len(self.ends)

    def entries(self) -> str:
        """The axes and permutations as JSON, as the native part reads them."""
        return json.dumps(list(self._entries()))

    def parameters(self) -> dict[str, Any]:
        """What a report says about them."""
        said: dict[str, Any] = {"bounds": [list(ends) for ends in self.ends]}
        whole = [self._flags["integer"][axis] or axis in self.exact for axis in range(len(self))]
        for name, values in {**self._flags, "integrality": whole}.items():
            if name != "integer" and any(values):
                said[name] = values
        if self._labels:
            said["categories"] = {str(axis): [str(label) for label in labels] for axis, labels in self._labels.items()}
        if self._places:
            said["permutations"] = list(self._places.values())
        return said

    def _entries(self) -> Iterator[dict[str, Any]]:
        for axis, (lower, upper) in enumerate(self.ends):
            if axis in self._labels:
                yield {"categories": [str(label) for label in self._labels[axis]]}
            elif axis in self._places:
                yield {"permutation": len(self._places[axis])}
            elif axis not in self.exact:
                yield {"lower": lower, "upper": upper, **{name: True for name, values in self._flags.items() if values[axis]}}

    def _take(self, name: str, axis: int, pairs: list[Any]) -> None:
        if not 0 <= axis < len(pairs):
            raise ValueError(f"{name} names axis {axis}, but the axes are 0 to {len(pairs) - 1}")
        if axis in self._labels or any(axis in group for group in self._places.values()):
            raise ValueError(f"axis {axis} is named twice by categories and permutations")
        for kind in ("logarithmic", "periodic"):
            if self._flags[kind][axis]:
                raise ValueError(f"axis {axis} has an entry in {name}: it cannot be {kind}")

    def _take_permutation(self, group: list[int], pairs: list[Any]) -> None:
        if not group:
            raise ValueError("permutations has an empty group: give the axes of each, such as range(0, 5)")
        if group != list(range(group[0], group[0] + len(group))):
            raise ValueError(f"permutations has the axes {group}: axes of one permutation follow each other, such as range(0, 5)")
        for axis in group:
            self._take("permutations", axis, pairs)
            pairs[axis] = (0, len(group) - 1)
        self._places[group[0]] = group

    def _ends(self, axis: int, pair: Any) -> tuple[float, float]:
        try:
            lower, upper = (real("bounds", end) for end in pair)
        except (TypeError, ValueError):
            raise ValueError(f"bounds of axis {axis} are {pair!r}: give (lower, upper)") from None
        if not (math.isfinite(lower) and math.isfinite(upper)):
            raise ValueError(f"bounds of axis {axis} are {pair!r}: both have to be finite")
        if self._flags["integer"][axis] and not (_is_whole(lower) and _is_whole(upper)):
            raise ValueError(f"bounds of axis {axis} are {pair!r}: an integer axis has whole ends below 2**53")
        return lower, upper


def _pairs(bounds: Any) -> list[Any]:
    if not (hasattr(bounds, "lb") and hasattr(bounds, "ub")):
        try:
            return list(bounds)
        except TypeError:
            raise TypeError(f"bounds must be a sequence of (lower, upper), one for each axis, not {bounds!r}") from None
    lower, upper = as_list(bounds.lb), as_list(bounds.ub)  # scipy.optimize.Bounds
    count = max(len(lower), len(upper))
    if not {len(lower), len(upper)} <= {1, count}:
        raise ValueError(f"bounds has {len(lower)} lower and {len(upper)} upper ends: give as many of both")
    lower, upper = (ends * count if len(ends) == 1 else ends for ends in (lower, upper))
    return list(zip(lower, upper, strict=True))


def _flags(name: str, value: Any, count: int) -> list[bool]:
    if value is None:
        return [False] * count
    flags = [_flag(name, flag) for flag in as_list(value)]
    flags = flags * count if is_number(value) else flags
    if len(flags) != count:
        raise ValueError(f"{name} has {len(flags)} entries for {count} axes")
    return flags


def _flag(name: str, value: Any) -> bool:
    # scipy's integrality is 0 or 1.
    if isinstance(value, (bool, np.bool_, int, float, np.number)) and value in (0, 1):
        return bool(value)
    raise TypeError(f"{name} must be True or False, or one of them for each axis, not {value!r}")


def _categories(value: Any) -> Iterator[tuple[int, list[Any]]]:
    if value is None:
        return
    if not isinstance(value, Mapping):
        raise TypeError(f"categories must map axes to their labels, such as {{2: ['steel', 'brass']}}, not {value!r}")
    for axis, labels in value.items():
        try:
            yield _axis("categories", axis), list(labels)
        except TypeError:
            if hasattr(labels, "__iter__"):
                raise
            raise TypeError(f"categories of axis {axis} must be its labels, such as ['steel', 'brass'], not {labels!r}") from None


def _groups(value: Any) -> Iterator[list[int]]:
    if value is None:
        return
    groups = list(value) if hasattr(value, "__iter__") else [value]
    if isinstance(value, str) or not all(hasattr(group, "__iter__") for group in groups):
        raise TypeError(f"permutations must be groups of axes, such as [range(0, 5)], not {value!r}")
    for group in groups:
        yield [_axis("permutations", axis) for axis in group]


def _axis(name: str, value: Any) -> int:
    try:
        return whole(name, value, least=-(2**63))
    except TypeError:
        raise TypeError(f"{name} names axis {value!r}: axes are whole numbers, the first one is 0") from None


def _is_whole(number: float) -> bool:
    return abs(number) < _MOST and number == math.floor(number)


def is_number(value: Any) -> bool:
    """Whether a value is a scalar, and not a sequence or an array of some length."""
    if hasattr(value, "ndim"):
        return bool(value.ndim == 0)
    return not hasattr(value, "__len__")


def as_list(value: Any) -> list[Any]:
    """The items of a sequence, or a scalar as the only one."""
    return [value] if is_number(value) else list(value)
