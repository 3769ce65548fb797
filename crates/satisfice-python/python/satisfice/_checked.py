"""Arguments, checked: an error names the argument and says what to give."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

Exceptions = tuple[type[BaseException], ...]


def real(name: str, value: Any) -> float:
    """A real number; text is none."""
    if isinstance(value, np.ndarray) and value.ndim == 0 and not np.ma.is_masked(value):
        value = value.item()
    if not isinstance(value, (str, bytes, bytearray, bool, np.ndarray)):
        try:
            return float(value)
        except (TypeError, ValueError):
            pass
        except OverflowError:
            raise ValueError(f"{name} is too large for a float") from None
    raise TypeError(f"{name} must be a real number, not {value!r}")


def positive(name: str, value: Any) -> float:
    """A real number above 0, which may be infinite."""
    number = real(name, value)
    if not number > 0:
        raise ValueError(f"{name} = {number} is not allowed: a positive number")
    return number


def seconds(value: Any, name: str = "time") -> float | None:
    """A time limit; None for none."""
    if value is None:
        return None
    number = real(name, value)
    if not (0 < number < math.inf):
        raise ValueError(f"{name} = {number} is not allowed: a positive number of seconds, or None for no limit")
    if number >= 2.0**64:
        raise ValueError(f"{name} = {number} is not allowed: at most 1e19 seconds, or None for no limit")
    return number


def whole(name: str, value: Any, least: int = 1, most: int = 2**64 - 1) -> int:
    """A whole number, also as 1e6."""
    if isinstance(value, (float, np.floating)) and float(value).is_integer():
        value = int(value)
    try:
        if isinstance(value, bool):
            raise TypeError
        number = int(value.__index__())
    except (AttributeError, TypeError):
        raise TypeError(f"{name} must be a whole number, not {value!r}") from None
    if not least <= number <= most:
        end = "2**64 - 1" if most == 2**64 - 1 else str(most)
        raise ValueError(f"{name} = {number} is not allowed: a whole number from {least} to {end}")
    return number


def whole_or_none(name: str, value: Any, least: int = 1) -> int | None:
    """A whole number; None for no limit."""
    return None if value is None else whole(name, value, least)


def processes(name: str, value: Any) -> int:
    """A number of processes, within the limit that the command has; more is a typing error."""
    return whole(name, value, 1, 1024)


def is_count(value: Any) -> bool:
    """Whether a place for evaluations is a number of processes."""
    return hasattr(value, "__index__") or isinstance(value, float)


def workers_of(value: Any) -> Any:
    """The workers of `workers=`: a number of processes, a function like ``map``, or an executor."""
    if is_count(value):
        return processes("workers", value)
    if not (callable(value) or hasattr(value, "submit")):
        raise TypeError(f"workers must be a number of processes, a function such as pool.map, or an executor, not {value!r}")
    if getattr(value, "__name__", "") == "imap_unordered":
        raise ValueError("workers=pool.imap_unordered gives values in another order than that of the points: pass pool.imap or pool.map")
    return value


def executor_of(value: Any) -> Any:
    """The executor of `executor=`: a number of processes, an executor, or a Dask client."""
    if is_count(value):
        return processes("executor", value)
    if value is not None and not hasattr(value, "submit"):
        raise TypeError(f"{value!r} is no executor: give a number of processes, an executor of concurrent.futures, or a Dask client")
    return value


def ticket_numbers(value: Any) -> NDArray[np.uint64]:
    """An array of tickets: whole numbers, exactly. numpy makes floats of unsigned and signed ones together."""
    array = np.atleast_1d(value)
    if array.dtype.kind not in "iu" and (array.dtype.kind == "O" or not isinstance(value, np.ndarray)):
        array = np.atleast_1d(np.array(value, dtype=object))
    if array.dtype.kind == "O":
        strange = [entry for entry in array.flat if isinstance(entry, bool) or not hasattr(entry, "__index__")]
        if strange:
            kind = type(strange[0]).__name__
            raise TypeError(f"tickets are of type {kind}: they are whole numbers, as `ask` gave them, not {strange[0]!r}")
    elif array.size and array.dtype.kind not in "iu":
        raise TypeError(f"tickets are of type {array.dtype}: they are whole numbers, as `ask` gave them")
    if array.size and not (array.min() >= 0 and array.max() < 2**64):
        raise ValueError(f"ticket {array.min() if array.min() < 0 else array.max()} was never given out")
    return np.ascontiguousarray(array, dtype=np.uint64)


def reals(name: str, value: Any) -> NDArray[np.float64]:
    """An array of real numbers, in one piece. NaN and infinities are left to the caller."""
    if np.ma.is_masked(value):
        raise ValueError(f"{name} must have no masked entries: leave them out, or fill them")
    try:
        array = np.asarray(value)
        wrong = _not_real(array)
        if wrong is None:
            return np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        wrong = str(error)
    raise ValueError(f"{name} must be real numbers: {wrong}")


def _not_real(array: NDArray[Any]) -> str | None:
    """What is no real number. numpy takes None for NaN, the text "1" for 1, and the real part of complex numbers."""
    if array.dtype.kind == "O":
        # Fractions, decimals and integers of any size.
        strange = [entry for entry in array.flat if not hasattr(entry, "__float__") or isinstance(entry, complex)]
        return f"could not convert {strange[0]!r}" if strange else None
    return None if array.dtype.kind in "biuf" else f"could not convert an array of type {array.dtype}"


def exceptions(value: Any) -> Exceptions:
    """The exceptions of `catch=`."""
    kinds = value if isinstance(value, tuple) else (value,)
    for kind in kinds:
        if not (isinstance(kind, type) and issubclass(kind, BaseException)):
            raise TypeError(f"catch must be an exception type or a tuple of them, such as ValueError, not {kind!r}")
    return kinds
