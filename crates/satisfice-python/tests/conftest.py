"""What several tests use."""

import json
import signal
import subprocess
import sys

import pytest

# A shell lets what it starts in the background ignore Ctrl-C: tests that interrupt themselves would wait for ever.
signal.signal(signal.SIGINT, signal.default_int_handler)

TIMES = {"elapsed_seconds", "overshoot_seconds", "seconds"}


def without_times(report):
    """The JSON of a report without what differs from run to run."""
    return _without_times(json.loads(report))


def _without_times(value):
    if isinstance(value, dict):
        return {key: _without_times(part) for key, part in value.items() if key not in TIMES}
    if isinstance(value, list):
        return [_without_times(part) for part in value]
    return value


def same(one, two):
    """Whether two reports differ in nothing but times and the name of the function."""
    reports = [without_times(report.to_json()) for report in (one, two)]
    for report in reports:
        report["problem_parameters"].pop("function")
    return reports[0] == reports[1]


def command(*arguments, **options):
    """The command as a user runs it."""
    return subprocess.run(
        [sys.executable, "-m", "satisfice", *map(str, arguments)], capture_output=True, text=True, timeout=60, **options
    )


@pytest.fixture
def circle():
    """Distance from the unit circle."""

    def distance(x):
        return abs((x[0] ** 2 + x[1] ** 2) ** 0.5 - 1.0)

    return distance
