# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall: drop tests of rigid missiles on foam pads, from Python (docs/python.md).

    case = softfall.Case("case.cfg")
    case["missile.velocity"] = "5.2 m/s"
    drop = case.run(threads=2)
    print(drop.verdict, drop.figures["hic"])

The programs of softfall compute everything; this package starts them and reads their files. Units are those of the files: SI in
`history` and `frames`, and what the key of a figure ends with ("a_max_g", "hic_t1_ms"). Figures indicate, they do not certify.
"""
import importlib.util

from .errors import Error, InputError, Interrupted, NumericError, SoftfallWarning, lacking

if _missing := [name for name in ("numpy", "h5py", "pandas") if importlib.util.find_spec(name) is None]:
    raise ModuleNotFoundError(lacking(_missing), name=_missing[0])

from . import cards
from .case import Case, Step, example
from .curves import cfc, hic
from .drop import Drop, Verdict, read_results
from .function import Function, function
from .library import version
from .rating import Rating, rate
from .record import Record, read_record
from .refinement import Refined, refine
from .study import Fit, Table, fit_compression, sweep

__all__ = ["Case", "Drop", "Error", "Fit", "Function", "InputError", "Interrupted", "NumericError", "Rating",
           "Record", "Refined", "SoftfallWarning", "Step", "Table", "Verdict", "cards", "cfc", "example", "fit_compression", "function", "hic", "rate",
           "read_record", "read_results", "refine", "sweep", "version"]
