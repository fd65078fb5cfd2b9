# SPDX-License-Identifier: GPL-3.0-or-later
"""Foam cards of other solvers (docs/cards.md): one module for each format, one foam between them and material.cfg."""
from .foam import Foam
from .material import export, read_card, read_foam, write_material

__all__ = ["Foam", "export", "read_card", "read_foam", "write_material"]
