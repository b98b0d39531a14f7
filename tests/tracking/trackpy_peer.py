# SPDX-License-Identifier: MIT
"""trackpy from a checkout on PYTHONPATH (github.com/soft-matter/trackpy), and its link_strategy of any size.

Debian 12 has no package of it; what it needs is there: python3-numpy, python3-scipy, python3-pandas, python3-numba.
"""
import sys
import warnings

import numpy as np
from scipy.optimize import linear_sum_assignment

warnings.filterwarnings("ignore")
try:
    import looseversion
except ImportError:  # the standard library has it too, until Python 3.12
    import distutils.version
    sys.modules["looseversion"] = distutils.version
import trackpy

trackpy.quiet()


def lsa(source_set, dest_set, search_range, max_size=None, **_):
    """scipy's dense assignment, with one private dummy of cost search_range² for each source."""
    sources = list(source_set)
    dests = list(dest_set)
    if len(sources) <= 1 and len(dests) <= 1:  # as trackpy's own strategies have it
        return sources or [None], dests or [None]
    place = {d: j for j, d in enumerate(dests)}
    cost = np.full((len(sources), len(dests) + len(sources)), 1e6 * search_range**2)
    for i, s in enumerate(sources):
        cost[i, len(dests) + i] = search_range**2
        for d, dist in s.forward_cands:
            if d is not None:
                cost[i, place[d]] = dist**2
    rows, columns = linear_sum_assignment(cost)
    linked = [dests[j] if j < len(dests) else None for j in columns]
    taken = set(linked)
    free = [d for d in dests if d not in taken]
    return [sources[i] for i in rows] + [None] * len(free), linked + free
