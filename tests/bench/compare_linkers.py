#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs trackpy, trackpy with a polynomial solver (lsa) and rapidptv on the same points: time, and links that differ.

usage: PYTHONPATH=TRACKPY compare_linkers.py BUILD [--without-gc] [CASE...]

BUILD: a build folder of preset release, as build/release. CASE: some of those below, as walk20000_0.5, or whole; default: all.

TRACKPY is a checkout of github.com/soft-matter/trackpy. CPU time of one thread; p50 and p99 of a frame's milliseconds. Python
collects garbage as it always does, or, for what the algorithms alone take, not at all with --without-gc. A peer that needs more
than two minutes is stopped: "stuck". Links differ where a point has another predecessor. The last line compares whole processes, CSV to CSV, as seconds of CPU and MiB.
"""
import ctypes
import gc
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas as pd

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "tracking"), str(HERE.parents[1] / "docs/clients")]
LIMIT_S = 120
FRAMES = 50
WITHOUT_GC = "--without-gc"
CASES = [  # case, N, ratio, search range, predictor of ours
    ("walk", 1000, 0.1, 0.105, "none"), ("walk", 1000, 0.3, 0.315, "none"), ("walk", 1000, 0.5, 0.525, "none"),
    ("walk", 5000, 0.3, 0.315, "none"), ("walk", 5000, 0.5, 0.525, "none"), ("gauss", 1000, 0.3, 0.9, "none"),
    ("gauss", 1000, 0.5, 1.0, "none"), ("walk", 20000, 0.1, 0.105, "none"), ("walk", 20000, 0.3, 0.315, "none"),
    ("walk", 20000, 0.5, 0.525, "none"), ("flow", 1000, 1.0, 0.25, "velocity"), ("flow", 5000, 1.0, 0.25, "velocity"),
    ("flow", 5000, 1.0, 0.25, "flow")]


def peer(strategy, file, search_range):
    """In a process of its own: links the table, prints the frames' milliseconds, writes the identities beside it."""
    from trackpy_peer import lsa, trackpy
    from trackpy.predict import NearestVelocityPredict
    points = pd.read_csv(file)
    axes = ["x", "y", "z"]
    keywords = {"link_strategy": lsa} if strategy.startswith("lsa") else {}
    if strategy.startswith("lsa"):
        trackpy.linking.linking.Linker.MAX_NEIGHBORS = 32
    frames = [f for _, f in points.groupby("frame")]
    times, ids = [], []
    if WITHOUT_GC in sys.argv:
        gc.disable()
    if strategy.endswith("velocity"):
        known = frames[0][frames[0].known_vx != 0]
        guess = NearestVelocityPredict(known[axes].to_numpy(), known[["known_vx", "known_vy", "known_vz"]].to_numpy(), axes)
        source = guess.link_df_iter(iter(frames), search_range, pos_columns=axes, **keywords)
        linked = (f.particle.to_numpy() for f in source)
    else:
        linked = (i for _, i in trackpy.link_iter(((k, f[axes].to_numpy()) for k, f in enumerate(frames)), search_range, **keywords))
    while True:
        begin = time.thread_time()
        one = next(linked, None)
        if one is None:
            break
        times.append(1e3 * (time.thread_time() - begin))
        ids.append(one)
    np.save(str(file) + f".{strategy}.npy", np.concatenate(ids))
    print(json.dumps(times[3:]))


def run_peer(strategy, file, search_range):
    """(milliseconds, identities), or (None, what happened)."""
    command = [sys.executable, __file__, "--peer", strategy, str(file), str(search_range)]
    command += [WITHOUT_GC] if WITHOUT_GC in sys.argv else []
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return None, "stuck"
    if done.returncode != 0:
        return None, "raises" if "SubnetOversize" in done.stderr else done.stderr[-300:]
    return json.loads(done.stdout), np.load(str(file) + f".{strategy}.npy")


def predecessors(points, ids):
    """For every row the row of the frame before that has the same identity, or -1."""
    found = np.full(len(points), -1)
    last = {}
    for _, rows in points.groupby("frame").indices.items():
        now = {ids[row]: row for row in rows}
        for identity, row in now.items():
            found[row] = last.get(identity, -1)
        last = now
    return found


def right(points, ids):
    theirs = predecessors(points, points.truth.to_numpy())
    later = theirs >= 0
    return np.mean(predecessors(points, ids)[later] == theirs[later])


def ours(build, case, points, search_range, predict):
    from link_df import link_df
    line = subprocess.run([build / "tests/bench/rptv_bench_linker", "one", *map(str, case), str(FRAMES)], capture_output=True,
                          text=True, check=True).stdout.splitlines()[-1].split()
    ids = None if predict != "none" else link_df(points, search_range, ["x", "y", "z"]).particle.to_numpy()
    return float(line[5]), float(line[6]), float(line[11]), ids


def compare(build, case, folder):
    name, count, ratio, search_range, predict = case
    file = folder / f"{name}{count}_{ratio}.csv"
    with open(file, "w") as out:
        subprocess.run([build / "tests/bench/rptv_bench_linker", "points", *map(str, case), str(FRAMES)], stdout=out, check=True)
    points = pd.read_csv(file)
    p50, p99, share, our_ids = ours(build, case, points, search_range, predict)
    text = f"{name:5} {count:6} {ratio:4} {search_range:6} {predict:9} {p50:8.3f} {p99:8.3f}"
    suffix = "" if predict == "none" else "velocity"
    for strategy in ("stock", "lsa"):
        times, ids = run_peer(strategy + suffix, file, search_range)
        if times is None:
            text += f" | {ids:>8} {'':8} {'':7} {'':>8}"
            continue
        differ = str(np.sum(predecessors(points, ids) != predecessors(points, our_ids))) if our_ids is not None else ""
        if suffix:
            differ = f"{right(points, ids):.4f}"
        text += f" | {np.median(times):8.1f} {np.percentile(times, 99):8.1f} {np.median(times) / p50:6.0f}x {differ:>8}"
    print(text + (f" | ours {share:.4f} right" if suffix else ""), flush=True)


def whole_process(build, folder):
    file = folder / "whole.csv"
    with open(file, "w") as out:
        subprocess.run([build / "tests/bench/rptv_bench_linker", "points", "walk", "5000", "0.3", "0.315", "none", "50"], stdout=out, check=True)
    slim = pd.read_csv(file)[["frame", "x", "y", "z"]]
    slim.to_csv(file, index=False)
    theirs = ("import sys; sys.path.insert(0, sys.argv[2]); from trackpy_peer import trackpy; import pandas as pd;"
              "trackpy.link(pd.read_csv(sys.argv[1]), 0.315).to_csv('/dev/null')")
    commands = {"rapidptv link": [build / "daemon/rapidptv", "link", file, "--search-range", "0.315", "--memory", "0", "-o", os.devnull],
                "trackpy": [sys.executable, "-c", theirs, file, HERE.parent / "tracking"]}
    for name, command in commands.items():
        runs = []
        for _ in range(5 if name == "rapidptv link" else 1):
            # From a small process, as a child's peak of memory counts from its parent's size on.
            small = ("import os,sys; p = os.spawnv(os.P_NOWAIT, sys.argv[1], sys.argv[1:]); u = os.wait4(p, 0)[2];"
                     "print(u.ru_utime + u.ru_stime, u.ru_maxrss / 1024)")
            done = subprocess.run([sys.executable, "-S", "-c", small, *map(str, command)], capture_output=True, text=True, check=True)
            runs.append(tuple(map(float, done.stdout.split()[-2:])))
        print(f"whole process, 5000 walk 0.3, 50 frames: {name:14} {min(r[0] for r in runs):6.3f} s CPU  {min(r[1] for r in runs):6.1f} MiB")


def main():
    build = Path(sys.argv[1]).resolve()
    os.environ["RPTV_LINKER"] = str(build / "tracking/librptv_linker.so")
    print(f"{'case':5} {'N':>6} {'ratio':4} {'range':>6} {'ours':9} {'p50':>8} {'p99':>8} | {'trackpy':>8} {'p99':>8} {'ratio':>7} "
          f"{'differ':>8} | {'lsa':>8} {'p99':>8} {'ratio':>7} {'differ':>8}   (flow: links right instead of differ)")
    with tempfile.TemporaryDirectory() as folder:
        wanted = [a for a in sys.argv[2:] if a != WITHOUT_GC]
        for case in CASES:
            if not wanted or f"{case[0]}{case[1]}_{case[2]}" in wanted:
                compare(build, case, Path(folder))
        if not wanted or "whole" in wanted:
            whole_process(build, Path(folder))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--peer"]:
        peer(sys.argv[2], sys.argv[3], float(sys.argv[4]))
    elif len(sys.argv) < 2:
        sys.exit(__doc__)
    else:
        main()
