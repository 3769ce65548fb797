"""What there is by name: engines, and the problems of the catalogue."""

from __future__ import annotations

import functools
import json
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from . import _satisfice


@dataclass(frozen=True)
class Parameter:
    """A parameter of an engine or a problem.

    Attributes
    ----------
    name, summary : str
        Its name, and what it does.
    kind : str
        ``"integer"``, ``"real"``, ``"optional-real"`` (a number or ``"auto"``), ``"choice"`` or ``"text"``.
    default : int, float or str
        Its default.
    min, max : int, float or None
        The range of a number.
    of : tuple of str
        The words of a choice.
    """

    name: str
    summary: str
    kind: str
    default: int | float | str
    min: int | float | None = None
    max: int | float | None = None
    of: tuple[str, ...] = ()


@dataclass(frozen=True)
class Engine:
    """An engine: what `find(..., engine=name, options={...})` accepts.

    Attributes
    ----------
    name, summary, reference : str
        Its name, what it does, and where it was published.
    parameters : mapping of str to Parameter
        Its options by name, those that all engines have included.
    """

    name: str
    summary: str
    reference: str
    parameters: Mapping[str, Parameter]


@dataclass(frozen=True)
class ProblemInfo:
    """A problem of the catalogue; `problem(name, ...)` builds it.

    Attributes
    ----------
    name, summary, reference : str
        Its name, what its hits are, and where it comes from.
    parameters : mapping of str to Parameter
        Its parameters by name.
    """

    name: str
    summary: str
    reference: str
    parameters: Mapping[str, Parameter]


@functools.cache
def _listing() -> Any:
    return json.loads(_satisfice.listing())


def _parameters(*tables: list[dict[str, Any]]) -> Mapping[str, Parameter]:
    rows = (Parameter(**{**row, "of": tuple(row.get("of", ()))}) for table in tables for row in table)
    return MappingProxyType({row.name: row for row in rows})


def engines() -> dict[str, Engine]:
    """Every engine by its name.

    Returns
    -------
    dict of str to Engine

    Examples
    --------
    >>> import satisfice
    >>> satisfice.engines()["latest-hit-qpso"].parameters["particles"].default
    30
    """
    common = _listing()["common_engine_parameters"]
    return {
        row["name"]: Engine(row["name"], row["summary"], row["reference"], _parameters(row["parameters"], common))
        for row in _listing()["engines"]
    }


def problems() -> dict[str, ProblemInfo]:
    """Every problem of the catalogue by its name.

    Returns
    -------
    dict of str to ProblemInfo

    Examples
    --------
    >>> import satisfice
    >>> satisfice.problems()["queens"].parameters["n"].default
    8
    """
    return {
        row["name"]: ProblemInfo(row["name"], row["summary"], row["reference"], _parameters(row["parameters"]))
        for row in _listing()["problems"]
    }


def problem(name: str, **parameters: Any) -> _satisfice.Problem:
    """A problem of the catalogue with its parameters set.

    Parameters
    ----------
    name : str
        Its name, see `problems`.
    **parameters
        Its parameters; ``_`` stands for ``-`` in a name. Those that are missing have their defaults.

    Returns
    -------
    Problem
        It can be searched by `find` any number of times.

    Raises
    ------
    ValueError
        For an unknown name, with the nearest one, or a value out of range.

    Examples
    --------
    >>> import satisfice
    >>> queens = satisfice.problem("queens", n=6)
    >>> satisfice.find(queens, evaluations=20_000, seed=1).hits
    4
    """
    return _satisfice.Problem(name, texts(parameters))


def texts(settings: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Settings as a command line writes them."""
    return [(name.replace("_", "-"), _text(value)) for name, value in settings.items()]


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None:
        return "auto"
    return str(value)
