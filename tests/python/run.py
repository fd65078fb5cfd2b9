# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the tests of the Python package: run.py FILE... [OPTION...]. Exit code 77 if a package of Debian is missing, except under SF_NO_SKIP=1."""
import importlib.util
import os
import subprocess
import sys
import tempfile

NEEDED = {"pytest": "python3-pytest", "numpy": "python3-numpy", "h5py": "python3-h5py", "matplotlib": "python3-matplotlib",
          "scipy": "python3-scipy"}
missing = [package for module, package in NEEDED.items() if not importlib.util.find_spec(module)]
if missing:
    print(f"the tests of the Python package need {', '.join(missing)} for {sys.executable}")
    sys.exit(1 if os.environ.get("SF_NO_SKIP") == "1" else 77)
with tempfile.TemporaryDirectory(prefix="softfall-tests-", ignore_cleanup_errors=True) as folder:
    code = subprocess.call([sys.executable, "-W", "error::SyntaxWarning", "-m", "pytest", "-q", "-p", "no:cacheprovider", f"--basetemp={folder}/files", *sys.argv[1:]])
sys.exit(code)
