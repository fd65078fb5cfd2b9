# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebook gives what it shows."""
import os
import pathlib
import subprocess
import sys

import pytest


@pytest.mark.slow
def test_first_drop(here):
    source = pathlib.Path(os.environ["SF_SOURCE_DIR"])
    result = subprocess.run([sys.executable, str(source / "tools/notebook.py"), str(source / "examples/python/first_drop.ipynb"), "--check"],
                            capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
