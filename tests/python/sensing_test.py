# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames are decoded into range maps."""
import pathlib
import tempfile
import unittest

import numpy as np

import palpate
from shared import DEMO


class Designing(unittest.TestCase):
    def test_a_pattern_is_what_was_asked_for_and_can_be_written(self):
        rig, colors = palpate.read_rig(DEMO / "rig.yaml"), palpate.train_colors(DEMO / "training")
        design = palpate.design_pattern(rig, trained=colors, number_of_colors=4, period=23, distances=(600, 800))
        self.assertEqual(design.pattern.stripes, 4 * 3 + 1)  # each ordered pair of colours once
        self.assertGreater(design.largest_overlap, 0)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "pattern.yaml"
            design.pattern.write(path)
            read = palpate.read_pattern(path)
        self.assertEqual((read.period, read.stripes), (23, 13))

    def test_the_period_is_the_shortest_that_the_camera_resolves(self):
        rig = palpate.read_rig(DEMO / "rig.yaml")
        fine, coarse = (palpate.design_pattern(rig, min_camera_period=least) for least in (7, 14))
        for design, least in ((fine, 7), (coarse, 14)):
            self.assertGreaterEqual(design.camera_period, least)
            one_less = palpate.design_pattern(rig, period=design.pattern.period - 1)
            self.assertLess(one_less.camera_period, least)

    def test_what_cannot_be_is_refused(self):
        rig = palpate.read_rig(DEMO / "rig.yaml")
        for options, words in (({"number_of_colors": 1}, "number_of_colors is 1; it must be in"),
                               ({"axis": "z"}, "axis is 'z'; it must be one of 'x', 'y', 'auto'"),
                               ({"distances": (900, 500)}, "far is 500 mm; it must be >= 900")):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.design_pattern(rig, **options)


class Cameras(unittest.TestCase):
    def test_a_simulated_camera_plays_the_images_of_a_folder(self):
        camera = palpate.LiveCamera(f"simulated:{DEMO / 'frames'}", rate=100)
        shown = [palpate.read_frame(path) for path in sorted((DEMO / "frames").iterdir())]
        for _ in range(3):
            frame, number, time = camera.next()
            np.testing.assert_array_equal(frame, shown[number % len(shown)])
            self.assertAlmostEqual(time, number / 100)
        self.assertEqual(camera.warnings, [])

    def test_what_a_camera_does_not_offer_is_refused(self):
        for options, words in (({"rate": 0}, "rate is 0 frames/s; it must be > 0"), ({"gain": np.nan}, "gain is nan; it must be finite"),
                               ({"size": (100, 100)}, "another size is not possible")):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.LiveCamera(f"simulated:{DEMO / 'frames'}", **options)
        with self.assertRaisesRegex(palpate.InvalidInput, "it must be aravis:NAME"):
            palpate.LiveCamera("webcam")


class Decoding(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rig = palpate.read_rig(DEMO / "rig.yaml")
        cls.pattern = palpate.read_pattern(DEMO / "pattern.yaml")
        cls.colors = palpate.train_colors(DEMO / "training")
        cls.decoder = palpate.Decoder(cls.rig, cls.pattern, cls.colors)
        cls.frame = palpate.read_frame(DEMO / "frames/duck.png")

    def test_depths_are_those_of_the_scene(self):
        truth = palpate.read_range_map(DEMO / "truth/duck.tiff", DEMO / "rig.yaml").z
        decoded = self.decoder.decode(self.frame)
        both = np.isfinite(decoded.range.z) & np.isfinite(truth)
        self.assertGreater(both.sum(), 50_000)
        self.assertLess(np.median(np.abs(decoded.range.z - truth)[both]), 0.1)  # mm; docs/sensing-accuracy.md
        np.testing.assert_array_equal(decoded.reasons == 0, np.isfinite(decoded.range.z))
        np.testing.assert_array_equal(np.isfinite(decoded.sigma), np.isfinite(decoded.range.z))
        self.assertEqual(sum(decoded.counts.values()), decoded.range.z.size)
        self.assertEqual(decoded.counts["reconstructed"], np.isfinite(decoded.range.z).sum())

    def test_frames_that_do_not_fit_are_told_with_their_likely_cause(self):
        self.assertEqual(self.decoder.decode(self.frame).verdict, "accepted")
        swapped = self.decoder.decode(self.frame[..., ::-1])
        self.assertEqual(swapped.verdict, "wrong_channels")
        self.assertIn("red and blue are swapped", swapped.reason)

    def test_frames_of_any_layout_give_the_same_depths(self):
        depths = self.decoder.decode(self.frame).range.z
        np.testing.assert_array_equal(self.decoder.decode(np.asfortranarray(self.frame)).range.z, depths)
        self.assertTrue(np.isnan(self.decoder.decode(np.zeros_like(self.frame)).range.z).all())

    def test_half_the_resolution_has_half_the_size(self):
        half = palpate.Decoder(self.rig, self.pattern, self.colors, half_resolution=True)
        z = half.decode(self.frame).range.z
        self.assertEqual(z.shape, (self.frame.shape[0] // 2, self.frame.shape[1] // 2))
        self.assertEqual((half.rig.camera.width, half.rig.camera.height), z.shape[::-1])

    def test_wrong_frames_are_refused(self):
        for frame in (self.frame.astype(float), self.frame[..., :2], self.frame.astype(np.int16), "frame", None, self.frame[0, 0]):
            with self.assertRaisesRegex(palpate.InvalidInput, "frame: must be uint8 or uint16"):
                self.decoder.decode(frame)
        for frame in (self.frame[:-1], self.frame[..., 0], np.zeros((0, 0, 3), np.uint8)):
            with self.assertRaises(palpate.InvalidInput):
                self.decoder.decode(frame)

    def test_a_rig_in_other_units_is_told_or_refused(self):
        text = (DEMO / "rig.yaml").read_text()
        begin = text.index("data", text.index("\nt:"))
        numbers = text[text.index("[", begin) + 1:text.index("]", begin)]

        def rig_in(mm):
            with tempfile.TemporaryDirectory() as folder:
                path = pathlib.Path(folder) / "rig.yaml"
                scaled = ", ".join(str(float(number) / mm) for number in numbers.split(","))
                path.write_text(text.replace(numbers, scaled))
                return palpate.read_rig(path)

        with self.assertRaisesRegex(palpate.InvalidInput, "223.9 mm if the number is in metres"):
            rig_in(1000)
        with self.assertRaisesRegex(palpate.InvalidInput, "in micrometres"):
            rig_in(0.001)
        with self.assertWarnsRegex(UserWarning, "223.9 mm if the number is in inches"):
            rig_in(25.4)

    def test_wrong_settings_are_refused(self):
        with self.assertRaisesRegex(palpate.InvalidInput, "window_periods"):
            palpate.Decoder(self.rig, self.pattern, self.colors, window_periods=np.nan)
        with self.assertRaisesRegex(palpate.InvalidInput, "anchor"):
            palpate.Decoder(self.rig, self.pattern, self.colors, anchors=[(1, 2, 3)])
        with self.assertRaisesRegex(palpate.FileError, "pattern.yaml"):
            palpate.read_rig(DEMO / "pattern.yaml")


if __name__ == "__main__":
    unittest.main()
