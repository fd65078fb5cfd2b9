# SPDX-License-Identifier: GPL-3.0-or-later
"""The type of an array of numbers in signatures; docstrings give its shape."""
from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]
