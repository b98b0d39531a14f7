# SPDX-License-Identifier: MIT
"""docs/clients/link_df.py makes trackpy's tracks of trackpy's cases. usage: link_df_test.py (paths from the environment)"""
import os
import sys
import unittest
from pathlib import Path

import numpy as np
import pandas as pd

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "docs/clients"))
from link_df import link_df

FOLDER = SOURCE / "tests/tracking/data/trackpy"


def renumbered(ids):
    return pd.factorize(ids)[0].tolist()


class LinkDf(unittest.TestCase):
    def test_makes_the_same_tracks_as_trackpy(self):
        for case in pd.read_csv(FOLDER / "cases.csv").itertuples():
            points = pd.read_csv(FOLDER / f"{case.case}.csv")
            linked = link_df(points.drop(columns="particle"), (case.range_x, case.range_y, case.range_z), ["x", "y", "z"],
                             memory=case.memory, adaptive_stop=case.adaptive_stop or None, adaptive_step=case.adaptive_step,
                             predictor="velocity" if case.velocity else None)
            self.assertEqual(renumbered(linked.particle), renumbered(points.particle), case.case)

    def test_takes_a_shuffled_table_in_the_plane_and_leaves_it_alone(self):
        points = pd.DataFrame({"frame": [1.0, 0, 1, 0], "y": [0.1, 5, 5.1, 0], "x": 0.0, "mass": [1, 2, 3, 4]})
        linked = link_df(points, 1)
        self.assertNotIn("particle", points)
        self.assertEqual(linked.mass.tolist(), [2, 4, 1, 3])
        self.assertEqual(linked.particle.tolist(), [0, 1, 1, 0])
        self.assertTrue(np.issubdtype(linked.frame.dtype, np.integer))

    def test_says_what_is_wrong_with_settings(self):
        points = pd.DataFrame({"frame": [0], "x": [0.0], "y": [0.0]})
        with self.assertRaisesRegex(ValueError, "memory"):
            link_df(points, 1, memory=-1)
        with self.assertRaises(NotImplementedError):
            link_df(points, 1, dist_func=lambda a, b: 0)


if __name__ == "__main__":
    os.environ["RPTV_LINKER"]  # the library that was built
    unittest.main()
