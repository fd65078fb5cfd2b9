# SPDX-License-Identifier: GPL-3.0-or-later
"""`softfall fit`: a foam from measured drops (docs/identification.md).

`input.py` reads the file of a fit, `drops.py` simulates drops of foams in worker processes, `search.py` finds the foam by least squares, `posterior.py` what
else agrees with the drops, `files.py` and `page.py` write what was found.
"""
