#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests palpate-project, and the commands that show images with it, on an X server of its own.

usage: window_test.py PROJECT PALPATE"""
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

import numpy

PROJECT, PALPATE = sys.argv[1], sys.argv[2]
WIDTH, HEIGHT = 320, 240  # px of the screen
LONGEST = 20              # s for anything


def write_png(path, pixels):
    """Writes rows x columns of grey, or x (r, g, b), of 8 or 16 bits."""
    kind = 2 if pixels.ndim == 3 else 0
    rows = b"".join(b"\0" + row.astype(f">u{pixels.itemsize}").tobytes() for row in pixels)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    head = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8 * pixels.itemsize, kind, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
    return path


class Server:
    """An X server whose screen is a file."""

    def __init__(self, folder):
        read, write = os.pipe()
        self.folder = folder
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir",
                                        str(folder), "-nolisten", "tcp"], pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            self.environment = {**os.environ, "DISPLAY": ":" + number.readline().strip()}

    def close(self):
        self.server.terminate()
        self.server.wait()

    def screen(self):
        """Rows x columns x (r, g, b) of what the screen shows (XWD version 7, 32 bits a pixel, blue first)."""
        data = (self.folder / "Xvfb_screen0").read_bytes()
        header = struct.unpack(">25I", data[:100])
        size, width, height, bits, stride, colors = header[0], header[4], header[5], header[11], header[12], header[19]
        if (width, height, bits) != (WIDTH, HEIGHT, 32):
            raise ValueError(f"the screen is {width} x {height} px of {bits} bits")
        start = size + 12 * colors
        rows = numpy.frombuffer(data, numpy.uint8, stride * height, start).reshape(height, stride // 4, 4)
        return rows[:, :width, 2::-1]


class Follower:
    """palpate-project that is told what to show."""

    def __init__(self, server):
        self.program = subprocess.Popen([PROJECT, "--follow"], env=server.environment, stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        self.opened = self.program.stdout.readline().split()

    def show(self, path):
        self.program.stdin.write(f"{path}\n")
        self.program.stdin.flush()
        return self.program.stdout.readline().strip()

    def close(self):
        self.program.stdin.close()
        status = self.program.wait(LONGEST)
        self.program.stdout.close()
        return status


class WindowTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.server = Server(cls.folder)
        cls.random = numpy.random.default_rng(1)

    @classmethod
    def tearDownClass(cls):
        cls.server.close()
        cls.scratch.cleanup()

    def refused(self, *words, status=2, environment=None):
        done = subprocess.run([PROJECT, *map(str, words)], env=environment or self.server.environment, capture_output=True,
                              text=True, timeout=LONGEST)
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertTrue(done.stderr.startswith("palpate-project: error: "), done.stderr)
        return done.stderr

    def colors(self):
        return self.random.integers(0, 256, (HEIGHT, WIDTH, 3), numpy.uint8)

    def test_the_screen_is_the_image_bit_for_bit_and_then_the_next_one(self):
        follower = Follower(self.server)
        self.assertEqual(follower.opened[:3], ["open", str(WIDTH), str(HEIGHT)])
        self.assertEqual(int(self.server.screen().max()), 0)
        for _ in range(3):
            image = self.colors()
            self.assertEqual(follower.show(write_png(self.folder / "image.png", image)), "shown")
            numpy.testing.assert_array_equal(self.server.screen(), image)
        grey = self.random.integers(0, 256, (HEIGHT, WIDTH), numpy.uint8)
        self.assertEqual(follower.show(write_png(self.folder / "grey.png", grey)), "shown")
        numpy.testing.assert_array_equal(self.server.screen(), numpy.repeat(grey[:, :, None], 3, axis=2))
        deep = self.random.integers(0, 65536, (HEIGHT, WIDTH, 3), numpy.uint16)
        self.assertEqual(follower.show(write_png(self.folder / "deep.png", deep)), "shown")
        difference = numpy.abs(self.server.screen() - deep / 257)
        self.assertLessEqual(difference.max(), 0.5 + 1e-9)
        self.assertEqual(follower.close(), 0)

    def test_an_image_of_another_size_is_refused_and_what_was_shown_stays(self):
        follower = Follower(self.server)
        image = self.colors()
        follower.show(write_png(self.folder / "right.png", image))
        wrong = write_png(self.folder / "wrong.png", self.colors()[:200])
        answer = follower.show(wrong)
        self.assertTrue(answer.startswith(f"refused: {wrong}: has 320 x 200 px, and the monitor "), answer)
        self.assertIn("has 320 x 240 px. Images are shown pixel for pixel", answer)
        self.assertTrue(follower.show("/no/where.png").startswith("refused: /no/where.png"))
        numpy.testing.assert_array_equal(self.server.screen(), image)
        self.assertEqual(follower.close(), 0)
        self.assertIn("has 320 x 200 px", self.refused(wrong))

    def test_wrong_calls(self):
        self.assertIn("--monitor: is 7; it must be a number from 1 to 1, or one of ", self.refused("--follow", "--monitor", 7))
        self.assertIn("give an image", self.refused())
        for display, words in ((None, "DISPLAY is not set"), (":991", "DISPLAY=:991 does not answer")):
            environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
            if display:
                environment["DISPLAY"] = display
            self.assertIn(words, self.refused("--list", status=1, environment=environment))

    def test_monitors_are_listed_with_their_size(self):
        done = subprocess.run([PROJECT, "--list"], env=self.server.environment, capture_output=True, text=True, check=True)
        self.assertRegex(done.stdout, r"^1: \S.*, 320 x 240 px at 0, 0\n$")

    def palpate(self, *words, answers=""):
        return subprocess.run([PALPATE, *map(str, words)], env=self.server.environment, capture_output=True, text=True,
                              input=answers, timeout=LONGEST)

    def camera(self):
        folder = self.folder / "camera"
        folder.mkdir(exist_ok=True)
        write_png(folder / "0.png", self.random.integers(0, 200, (48, 64, 3), numpy.uint8))
        return f"simulated:{folder}"

    def drawn(self, name, *words):
        folder = self.folder / name
        if not folder.exists():
            subprocess.run([PALPATE, "pattern", "--size", str(WIDTH), str(HEIGHT), *words, "--grey-steps", "3", "-q", "-o",
                            str(folder)], check=True)
        return folder

    def test_training_takes_one_image_of_each_that_is_shown_under_its_name(self):
        pattern = self.drawn("pattern")
        taken = self.folder / "training"
        done = self.palpate("capture", "training", self.camera(), "--rate", 1000, "--settle", 0, "--show", pattern, "-o", taken,
                            "--json", answers="\n")
        self.assertEqual(done.returncode, 0, done.stderr)
        shown = {path.name for path in pattern.glob("*.png")} - {"pattern.png"}
        self.assertEqual({path.name for path in taken.iterdir()}, shown)
        self.assertEqual(json.loads(done.stdout)["images"], len(shown))
        again = self.palpate("capture", "training", self.camera(), "--show", pattern, "-o", taken, answers="\n")
        self.assertEqual(again.returncode, 2)

    def test_multishot_takes_all_images_with_each_exposure(self):
        shots = self.drawn("multishot", "--multishot", "3")
        taken = self.folder / "captures"
        done = self.palpate("capture", "multishot", self.camera(), "--rate", 1000, "--settle", 0, "--show", shots, "--exposures",
                            500, 2000, "-o", taken, answers="\n")
        self.assertEqual(done.returncode, 0, done.stderr)
        names = sorted(path.name for path in shots.glob("shot_*.png"))
        for folder in ("exposure_1", "exposure_2"):
            self.assertEqual(sorted(path.name for path in (taken / folder).iterdir()), names)
        self.assertIn(f"palpate decode {taken}/exposure_1 {taken}/exposure_2 --multishot --exposures 2", done.stdout)

    def test_the_pattern_is_on_the_screen_while_a_sequence_is_recorded(self):
        image = write_png(self.folder / "shown.png", self.colors())
        pixels = self.colors()
        write_png(image, pixels)
        recording = subprocess.Popen([PALPATE, "capture", "sequence", self.camera(), "--rate", "100", "--show", str(image), "-o",
                                      str(self.folder / "frames")], env=self.server.environment, stdout=subprocess.DEVNULL)
        end = time.monotonic() + LONGEST
        while not (self.folder / "frames" / "frame_000000.tiff").exists() and time.monotonic() < end:
            time.sleep(0.01)
        numpy.testing.assert_array_equal(self.server.screen(), pixels)
        recording.terminate()
        self.assertEqual(recording.wait(LONGEST), 0)

    def test_a_pose_without_a_board_is_dropped_and_said_so(self):
        show = self.folder / "show"
        subprocess.run([PALPATE, "calibrate", "rig", "--draw", str(show), "--projector-size", f"{WIDTH}x{HEIGHT}", "-q"],
                       check=True)
        done = self.palpate("capture", "calibration", self.camera(), "--rate", 1000, "--settle", 0, "--show", show, "--board",
                            "5x4", "--square", 20, "-o", self.folder / "poses", answers="\nq\n")
        self.assertEqual(done.returncode, 1)
        self.assertIn("Pose 1: hold the board facing the camera", done.stderr)
        self.assertIn("This pose is dropped", done.stderr)
        self.assertIn("no pose was taken", done.stderr)
        self.assertEqual(list((self.folder / "poses").glob("*")), [])

    def test_a_pattern_of_another_size_than_the_projector_is_refused(self):
        image = write_png(self.folder / "small.png", self.colors()[:100])
        done = self.palpate("capture", "sequence", self.camera(), "--show", image, "-o", self.folder / "none")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("has 320 x 100 px, and the monitor", done.stderr)
        self.assertFalse((self.folder / "none").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
