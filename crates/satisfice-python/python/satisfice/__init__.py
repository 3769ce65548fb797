"""Find as many good-enough answers as possible before a deadline, and say how complete they are.

>>> import satisfice
>>> def near_circle(x):
...     return abs((x[0] ** 2 + x[1] ** 2) ** 0.5 - 1.0)
>>> report = satisfice.find(near_circle, [(-2, 2), (-2, 2)], delta=0.01, separation=0.2, evaluations=20_000, seed=1)
>>> report.hits >= 15 and bool((report.fun < 0.01).all())
True

`find` searches a function or a problem of the catalogue; `engines` and `problems` list what there is by name.
"""

from . import collision
from ._find import Progress, find
from ._names import Engine, Parameter, ProblemInfo, engines, problem, problems
from ._satisfice import Best, Problem, Report, version
from ._search import Batch, Search

__version__ = version()

__all__ = [
    "Batch",
    "Best",
    "Engine",
    "Parameter",
    "Problem",
    "ProblemInfo",
    "Progress",
    "Report",
    "Search",
    "collision",
    "engines",
    "find",
    "problem",
    "problems",
]
