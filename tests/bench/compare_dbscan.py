#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares rapidptv's DBSCAN with scikit-learn's on the same voxels: the same cores, clusters and noise, and the time.

usage: compare_dbscan.py PATH/TO/rptv_bench_light_field    needs python3-sklearn; exits 1 when the labels differ.
"""
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from sklearn.cluster import DBSCAN


def same_partition(ours, theirs):
    """Whether two labellings of the same points differ in nothing but the numbers of their clusters."""
    pairs = {(a, b) for a, b in zip(ours.tolist(), theirs.tolist())}
    return len(pairs) == len({a for a, _ in pairs}) == len({b for _, b in pairs})


def compare(file):
    """Prints one line on one dumped cloud; returns whether cores and noise agree."""
    header = dict(item.split("=") for item in file.open().readline()[1:].split())
    table = np.loadtxt(file, delimiter=",", skiprows=2, dtype=np.int64)
    points, ours = table[:, :3].astype(np.float64), table[:, 3]
    model = DBSCAN(eps=float(header["eps"]), min_samples=int(header["min_samples"]), algorithm="kd_tree", n_jobs=1)
    times = []
    for _ in range(3 if len(points) < 5e5 else 1):
        begin = time.process_time()
        model.fit(points)
        times.append((time.process_time() - begin) * 1e3)
    cores = np.zeros(len(points), bool)
    cores[model.core_sample_indices_] = True
    same_cores = same_partition(ours[cores], model.labels_[cores])
    same_noise = bool(np.array_equal(ours < 0, model.labels_ < 0))
    ms = float(header["ms"])
    print(f"{len(points):7d} voxels: scikit-learn {np.median(times):8.1f} ms, ours {ms:7.2f} ms, ratio {np.median(times) / ms:5.1f}; "
          f"core labels {'identical' if same_cores else 'DIFFER'}, noise {'identical' if same_noise else 'DIFFERS'}, "
          f"border voxels elsewhere: {int(np.sum(ours[~cores] != model.labels_[~cores]))}")
    return same_cores and same_noise


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[1], "classification", f"--dump={folder}/cloud"], check=True)
        agree = [compare(file) for file in sorted(Path(folder).glob("cloud_*.csv"), key=lambda f: f.stat().st_size)]
    sys.exit(0 if agree and all(agree) else 1)


if __name__ == "__main__":
    main()
