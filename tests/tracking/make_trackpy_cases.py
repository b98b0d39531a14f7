#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the cases that trackpy_test.cpp compares with: points, and the tracks that trackpy itself makes of them.

usage: PYTHONPATH=TRACKPY make_trackpy_cases.py FOLDER

FOLDER gets one CASE.csv each (frame,x,y,z,particle) and cases.csv (how it was linked). TRACKPY is a checkout of
github.com/soft-matter/trackpy; the cases follow its own tests (trackpy/tests/test_linking.py, test_predict.py).
Needs python3-pandas and python3-scipy. Not run by the tests: their files are committed.
"""
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from trackpy_peer import lsa, trackpy
from trackpy.predict import NearestVelocityPredict


def frame_of(columns):
    points = pd.DataFrame(columns)
    for axis in "xyz":
        if axis not in points:
            points[axis] = 0.0
    return points[["frame", "x", "y", "z"]].sort_values("frame", kind="stable").reset_index(drop=True)


def steppers(*, y, drop=None, n=5):
    """Two particles in unit steps; the second comes one frame later, the first may miss a frame."""
    a = [(i, i, 1.0) for i in range(n) if i != drop]
    b = [(i, i, y + 1.0) for i in range(1, n)]
    return frame_of(dict(zip(("frame", "x", "y"), map(np.array, zip(*(a + b))))))


def grid(factor, n=10):
    x, y = (v.ravel() for v in np.mgrid[-n:n + 1, -n:n + 1] * 2.0)
    return frame_of({"frame": np.repeat([0, 1], x.size), "x": np.concatenate([x, factor * x]) + 200,
                     "y": np.concatenate([y, factor * y]) + 200})


def walk(seed, count, frames, step, dimensions, side, dropped=0.0, velocity=0.0):
    """Random walkers in a box, some of them unseen now and then; rows in random order."""
    random = np.random.RandomState(seed)
    start = random.uniform(0, side, (count, dimensions))
    drift = velocity * np.stack([np.cos(start[:, 1] / side * 6), np.sin(start[:, 0] / side * 6)] +
                                [np.cos(start[:, 0] / side * 6)] * (dimensions - 2), axis=1)
    path = start + np.cumsum(random.normal(0, step, (frames, count, dimensions)) + drift, axis=0)
    seen = [(f, *path[f, i]) for f in range(frames) for i in random.permutation(count) if random.uniform() >= dropped]
    return frame_of(dict(zip(("frame", "x", "y", "z")[:dimensions + 1], map(np.array, zip(*seen)))))


def rows(*points):
    return frame_of(dict(zip(("frame", "x", "y"), map(np.array, zip(*points)))))


def pathological():
    return rows(*((j, float(j), float(2 * k + j)) for j in range(5) for k in range(16)))


def duplicate_bug():
    """Real data with which an earlier trackpy gave one identity to two points."""
    data = Path(trackpy.__file__).parent / "tests/data/reproduce_duplicate_track_assignment.npy"
    points = pd.DataFrame(np.load(data))
    return frame_of({name: points[name] for name in ("frame", "x", "y")})


CASES = {  # name: points, keywords of trackpy.link
    "one_stepper": (rows(*((i, float(i), 1.0) for i in range(5))), dict(search_range=5)),
    "two_isolated_steppers": (steppers(y=25), dict(search_range=5)),
    "two_isolated_steppers_one_gapped": (steppers(y=25, drop=3), dict(search_range=5)),
    "two_nearby_steppers": (steppers(y=2), dict(search_range=5)),
    "two_nearby_steppers_one_gapped": (steppers(y=2, drop=3), dict(search_range=5)),
    "memory_on_one_gap": (steppers(y=2, drop=3), dict(search_range=5, memory=1)),
    "start_at_frame_3": (rows(*((3 + i, float(i), 1.0) for i in range(5))), dict(search_range=5)),
    "blank_frame": (rows((0, 0., 1.), (1, 1., 1.), (2, 2., 1.), (4, 3., 1.), (5, 4., 1.)), dict(search_range=5)),
    "memory_removal": (rows((0, 1., 1.), (0, 4., 1.), (1, 1., 1.), (2, 1., 1.), (2, 2., 1.), (3, 1., 1.), (3, 2., 1.),
                            (3, 4., 1.)), dict(search_range=5, memory=2)),
    "quadrature_distances": (rows((0, 6., 0.), (0, 15., 8.), (1, 8., 0.), (1, 0., 8.)), dict(search_range=20)),
    "quadrature_distances_reversed": (rows((0, 6., 0.), (0, 13., 8.), (1, 8., 0.), (1, 0., 8.)), dict(search_range=20)),
    "quadrature_sum": (rows((0, 10., 30.), (0, 10., 0.), (1, 0., 20.), (1, 30., 21.)), dict(search_range=30)),
    "quadrature_sum_reversed": (rows((0, 10., 30.), (0, 10., 0.), (1, 0., 20.), (1, 30., 19.)), dict(search_range=30)),
    "penalty_of_13": (rows((0, 0., 0.), (0, 8., 0.), (1, 7., 8.), (1, 15., 8.)), dict(search_range=13)),
    "penalty_of_12": (rows((0, 0., 0.), (0, 8., 0.), (1, 7., 8.), (1, 15., 8.)), dict(search_range=12)),
    "easy_tracking": (rows(*((j, float(j), float(2 * k)) for j in range(5) for k in range(16))), dict(search_range=1.5)),
    "pathological_shift": (pathological(), dict(search_range=8)),
    "contracting_grid_adaptive": (grid(0.9), dict(search_range=2, adaptive_step=0.8, adaptive_stop=0.64)),
    "contracting_grid": (grid(0.9), dict(search_range=2, link_strategy=lsa)),
    "duplicate_bug": (duplicate_bug(), dict(search_range=8, memory=2)),
    "walk_in_the_plane": (walk(1, 120, 12, 0.3, 2, 14), dict(search_range=0.8)),
    "walk_with_drop_outs": (walk(2, 80, 16, 0.2, 2, 14, dropped=0.1), dict(search_range=0.7, memory=3)),
    "walk_in_space": (walk(3, 120, 10, 0.2, 3, 6), dict(search_range=0.55)),
    "walk_in_space_with_drop_outs": (walk(4, 80, 16, 0.15, 3, 6, dropped=0.15), dict(search_range=0.5, memory=2)),
    "crowded_walk": (walk(5, 200, 6, 0.45, 3, 6), dict(search_range=0.9, link_strategy=lsa)),
    "range_per_axis": (walk(6, 100, 12, 0.2, 3, 6), dict(search_range=(0.3, 0.5, 0.9))),
    "adaptive_walk": (walk(7, 150, 8, 0.3, 2, 12), dict(search_range=1.2, adaptive_stop=0.3, adaptive_step=0.9)),
    "nearest_velocity": (walk(8, 80, 12, 0.02, 2, 20, velocity=0.8), dict(search_range=0.9, predictor=True)),
    "nearest_velocity_in_space": (walk(9, 100, 12, 0.02, 3, 9, velocity=0.4), dict(search_range=0.5, predictor=True)),
}


def link(points, search_range, predictor=False, **keywords):
    axes = ["x", "y", "z"]
    if predictor:
        return NearestVelocityPredict(pos_columns=axes).link_df(points, search_range, pos_columns=axes, **keywords)
    return trackpy.link(points, search_range, pos_columns=axes, **keywords)


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    table = ["case,range_x,range_y,range_z,memory,adaptive_stop,adaptive_step,velocity"]
    for name, (points, keywords) in CASES.items():
        points[["x", "y", "z"]] = points[["x", "y", "z"]].round(4)
        linked = link(points, **keywords)
        linked[["frame", "x", "y", "z", "particle"]].to_csv(folder / f"{name}.csv", index=False)
        ranges = keywords["search_range"] if isinstance(keywords["search_range"], tuple) else (keywords["search_range"],) * 3
        table.append(",".join(map(str, (name, *ranges, keywords.get("memory", 0), keywords.get("adaptive_stop", 0),
                                        keywords.get("adaptive_step", 0.95), int(keywords.get("predictor", False))))))
        print(name, len(points), "points", linked.particle.nunique(), "tracks")
    (folder / "cases.csv").write_text("\n".join(table) + "\n")


if __name__ == "__main__":
    main()
