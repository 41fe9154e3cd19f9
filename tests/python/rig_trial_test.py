# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""A simulated rig measures what its truth says."""
import pathlib
import tempfile
import unittest

import numpy as np

import palpate
from shared import DEMO


def plane(z, turn=0.0):
    """A square of 1 m around the axis of the camera, turned about the y axis."""
    x, y = np.array([[-500, 500, 500, -500], [-500, -500, 500, 500]])
    vertices = np.stack([x * np.cos(turn), y, z + x * np.sin(turn)], axis=1)
    return palpate.TriangleMesh(vertices, [[0, 1, 2], [0, 2, 3]])


class RigTrials(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        text = (DEMO / "rig.yaml").read_text()
        for full, half in (("[ 640, 480 ]", "[ 320, 240 ]"), ("1100.0, 0.0, 319.5, 0.0, 1100.0, 239.5", "550, 0, 159.5, 0, 550, 119.5")):
            assert text.count(full) == 1
            text = text.replace(full, half)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "rig.yaml"
            path.write_text(text)
            cls.rig = palpate.read_rig(path)
        cls.pattern = palpate.design_pattern(cls.rig, distances=(600, 800)).pattern

    def trial(self, bodies, **options):
        return palpate.try_rig(self.rig, self.pattern, bodies, **options)

    def test_the_truth_is_the_plane(self):
        turn, z = 0.2, 700
        trial = self.trial([palpate.Body(plane(z, turn))])
        x = (np.arange(320) - self.rig.camera.cx) / self.rig.camera.fx
        expected = np.broadcast_to(z / (1 - x * np.tan(turn)), (240, 320))
        np.testing.assert_allclose(trial.truth.z, expected, rtol=1e-6)
        self.assertEqual(trial.frame.shape, (240, 320, 3))
        self.assertTrue((trial.body == 0).all())
        self.assertEqual(sorted(trial.training), sorted(palpate.train_colors(DEMO / "training").names))

    def test_depths_are_right_and_noise_makes_them_worse(self):
        bodies = [palpate.Body(plane(700))]
        quiet, usual = (self.trial(bodies, full_well=full_well).assess() for full_well in (0, 12000))
        self.assertGreater(quiet.coverage, 0.9)
        self.assertLess(quiet.wrong_share, 1e-3)
        self.assertLess(quiet.median, 0.1)
        self.assertGreater(usual.median, 1.5 * quiet.median)
        self.assertEqual(sum(quiet.reasons.values()), quiet.lit)
        self.assertEqual(quiet.visible, quiet.outside + quiet.dark + quiet.lit)

    def test_scenery_can_be_left_out(self):
        near = plane(650)
        near.vertices[:, 0] += 500  # the right half of the image
        trial = self.trial([palpate.Body(near), palpate.Body(plane(800))])
        counted, both = trial.assess(counted_bodies=1), trial.assess()
        self.assertEqual(counted.visible, (trial.body == 0).sum())
        self.assertEqual(both.visible, trial.body.size)

    def test_what_cannot_be_is_refused(self):
        usual = palpate.Body(plane(700))
        for bodies, options, words in (([], {}, "no body"),
                                       ([usual], {"bits": 12}, "bits is 12; it must be 8 or 16"),
                                       ([usual], {"readout": "grey"}, "readout is 'grey'; it must be one of"),
                                       ([usual], {"read_noise": float("nan")}, "read_noise is nan"),
                                       ([palpate.Body(plane(700), specular=2)], {}, "specular")):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                self.trial(bodies, **options)

    def test_a_body_behind_the_camera_is_not_measured(self):
        trial = self.trial([palpate.Body(plane(-700))])
        self.assertIsNone(trial.decoded)
        self.assertNotEqual(trial.failure, "")
        with self.assertRaisesRegex(palpate.InvalidInput, "nothing was decoded"):
            trial.assess()


if __name__ == "__main__":
    unittest.main()
