#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests palpate-view on an X server of its own, with a window manager: its pictures, what a mouse does, wrong input.

usage: window_test.py VIEW PALPATE REPOSITORY PAGE; PAGE has the demo's model and acquisition (tests/web/make_page.py)."""
import csv
import itertools
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

VIEW, PALPATE, REPOSITORY, PAGE = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[4])
MODEL = PAGE / "model"
PANEL = 340           # px on the right of the picture
WIDTH, HEIGHT = 680, 400  # px
SIZE = ("--width", WIDTH, "--height", HEIGHT)
LONGEST = 20          # s for anything
TICK_BYTES, TOOL, CONTACT, STATE = 224, 160, 184, 208  # of a session: see haptics/loop_record.h
STATES = ["free", "stick", "slip"]
PRESSED = 700         # ticks of 1 ms, in which a tool sinks in


class Server:
    """An X server without a screen, and a window manager on it."""

    def __init__(self):
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x700x24", "-nolisten", "tcp"],
                                       pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            self.display = ":" + number.readline().strip()
        self.environment = {**os.environ, "DISPLAY": self.display}
        self.manager = subprocess.Popen(["openbox", "--sm-disable"], env=self.environment, stderr=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL)

    def close(self):
        for process in (self.manager, self.server):
            process.terminate()
            process.wait()

    def view(self, *words, cwd=None):
        return subprocess.run([VIEW, *map(str, words)], env=self.environment, capture_output=True, text=True, cwd=cwd,
                              timeout=LONGEST)

    def do(self, *words):
        return subprocess.run(["xdotool", *map(str, words)], env=self.environment, check=True, capture_output=True,
                              text=True, timeout=LONGEST).stdout


def palpate(*words):
    done = subprocess.run([PALPATE, *map(str, words)], check=True, capture_output=True, text=True)
    return done.stdout


def pixels_of(path):
    """The picture beside the panel, rows x columns x (r, g, b), of a PNG as OpenCV writes it: 8 bits, RGB, each row with the
    filter that takes the pixel on the left away."""
    data = pathlib.Path(path).read_bytes()
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", data[16:29])
    packed, place = b"", 8
    while place < len(data):
        size, name = struct.unpack(">I4s", data[place:place + 8])
        packed += data[place + 8:place + 8 + size] if name == b"IDAT" else b""
        place += size + 12
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + 3 * width)
    if (depth, kind, interlaced) != (8, 2, 0) or not (rows[:, 0] == 1).all():
        raise ValueError(f"{path}: not as OpenCV writes it")
    return numpy.cumsum(rows[:, 1:].reshape(height, width, 3), axis=1, dtype=numpy.uint8)[:, :width - PANEL]


def arrow(pixels):
    """The number of pixels with the blue of a force (theme.h), in light and shadow."""
    red, green, blue = (pixels[:, :, channel].astype(int) for channel in range(3))
    return int(((blue > 120) & (2 * blue > 3 * green) & (blue > 3 * red)).sum())


def different(a, b, least=12):
    """The number of pixels that differ by more than some units of a channel."""
    return int((numpy.abs(a.astype(int) - b).max(axis=2) > least).sum())


def ticks_of(session):
    """Tool, contact and state of each tick of a session."""
    data = session.read_bytes()
    data = data[data.index(b"\n") + 1:]
    for at in range(0, len(data) - TICK_BYTES + 1, TICK_BYTES):
        yield (struct.unpack_from("<3d", data, at + TOOL), struct.unpack_from("<3d", data, at + CONTACT),
               STATES[struct.unpack_from("<I", data, at + STATE)[0]])


def touching(session):
    """The number of ticks that touch, in a session that may still be written."""
    return sum(state != "free" for _, _, state in ticks_of(session)) if b"\n" in session.read_bytes() else 0


def wait_for(what, condition):
    end = time.monotonic() + LONGEST
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not within {LONGEST} s")
        time.sleep(0.02)


class WindowTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server()
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)

    @classmethod
    def tearDownClass(cls):
        cls.server.close()
        cls.scratch.cleanup()

    def picture(self, name, *words):
        path = self.folder / name
        done = self.server.view(*words, *SIZE, "--screenshot", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        return pixels_of(path)

    def refused(self, *words, status=2, environment=None):
        done = subprocess.run([VIEW, *map(str, words)], env=environment or self.server.environment, capture_output=True,
                              text=True, timeout=LONGEST)
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertTrue(done.stderr.startswith("palpate-view: error: "), done.stderr)
        return done.stderr

    def test_a_press_of_a_trajectory_shows_dent_and_arrow(self):
        tools = self.folder / "press.csv"
        tools.write_text("t,x,y,z\n0,0,0,690\n1,0,0,710\n")
        rest = self.picture("rest.png", MODEL, "--trajectory", tools, "--seconds", "0")
        pressed = self.picture("pressed.png", MODEL, "--trajectory", tools)
        again = self.picture("again.png", MODEL, "--trajectory", tools)
        self.assertEqual(arrow(rest), 0)
        self.assertGreater(arrow(pressed), 80)
        self.assertGreater(different(rest, pressed), 800, "the dent")
        self.assertLess(different(rest, pressed), 0.25 * rest.shape[0] * rest.shape[1], "the rest stays as it is")
        self.assertTrue((pressed == again).all(), "a picture can be made again")

    def test_a_mouse_presses_and_slides_and_its_session_is_played_again_to_the_bit(self):
        session = self.folder / "mouse.session"
        window = subprocess.Popen([VIEW, MODEL, *map(str, SIZE), "--session", session], env=self.server.environment, cwd=self.folder,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            number = self.server.do("search", "--sync", "--onlyvisible", "--name", "Palpate").split()[0]
            self.server.do("windowactivate", "--sync", number)
            x, y = (WIDTH - PANEL) // 2, HEIGHT // 2
            picture = itertools.count(1)

            def shot():
                path = self.folder / f"palpate-view-{next(picture)}.png"
                self.server.do("key", "--window", number, "p")
                wait_for(path.name, lambda: path.exists())
                return pixels_of(path)

            def shot_when(wanted):
                """The first picture that is as wanted, or the last one in time: a busy machine draws late."""
                end = time.monotonic() + LONGEST
                while not wanted(seen := shot()) and time.monotonic() < end:
                    time.sleep(0.1)
                return seen

            free = shot()
            self.server.do("mousemove", "--window", number, x, y, "mousedown", 1)
            wait_for("the press in the session", lambda: touching(session) > PRESSED)
            pressed = shot_when(lambda seen: arrow(seen) > 40 and different(free, seen) > 400)
            for step in range(1, 9):
                self.server.do("mousemove", "--window", number, x + 8 * step, y)
            slid = shot_when(lambda seen: different(pressed, seen) > 200)
            self.server.do("mouseup", 1, "mousemove", "--window", number, 5, 5)
            lifted = shot_when(lambda seen: arrow(seen) == 0 and different(free, seen) < 100)
            # At once, as it comes when pictures are slow: beside the object, a drag turns it.
            self.server.do("mousemove", "--window", number, 8, 8, "mousedown", 1, "mousemove", "--window", number, 120, 60,
                           "mouseup", 1)
            turned = shot_when(lambda seen: different(lifted, seen) > 2000 and arrow(seen) == 0)
            # Not "key": the window may be gone when the key is let go.
            self.server.do("keydown", "--window", number, "q")
            _, words = window.communicate(timeout=LONGEST)
        finally:
            window.kill()
            window.wait()
        self.assertEqual(window.returncode, 0, words)
        self.assertEqual(arrow(free), 0)
        self.assertGreater(arrow(pressed), 40)
        self.assertGreater(different(free, pressed), 400, "the dent")
        self.assertGreater(different(pressed, slid), 200, "the dent moved")
        self.assertEqual(arrow(lifted), 0)
        self.assertLess(different(free, lifted), 100, "the surface is as it was")
        self.assertGreater(different(lifted, turned), 2000)
        self.assertEqual(arrow(turned), 0)

        replayed = json.loads(palpate("play", MODEL, "--replay", session, "--json"))
        self.assertEqual(replayed["different"], 0)
        ticks = list(ticks_of(session))
        self.assertEqual(len(ticks), replayed["replayed"])
        self.assertGreater(touching(session), PRESSED)
        self.check_trace(ticks)
        # The window plays it as well, to the middle of the press.
        pressing = [i for i, (_, _, state) in enumerate(ticks) if state != "free"]
        again = self.picture("replayed.png", MODEL, "--replay", session, "--seconds", pressing[len(pressing) // 2] / 1000)
        self.assertGreater(arrow(again), 40)

    def check_trace(self, ticks):
        """The command plays the same way of the tool: contacts and states must be the same, bit by bit."""
        tools, trace = self.folder / "tools.csv", self.folder / "trace.csv"
        with tools.open("w") as file:
            file.write("t,x,y,z\n")
            for i, (tool, _, _) in enumerate(ticks):
                file.write(",".join(map(repr, [i / 1000, *tool])) + "\n")
        palpate("play", MODEL, "--trajectory", tools, "--record", trace)
        with trace.open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(ticks))
        for i, (row, (_, contact, state)) in enumerate(zip(rows, ticks)):
            self.assertEqual((tuple(float(row[c]) for c in ("cx", "cy", "cz")), row["state"]), (contact, state), f"tick {i}")

    def test_a_movie_of_a_mesh_turns_it(self):
        movie = self.folder / "movie"
        for _ in range(2):  # the second one replaces the first
            done = self.server.view(REPOSITORY / "meshes/hand.ply", *SIZE, "--movie", movie, "--seconds", "0.1")
            self.assertEqual(done.returncode, 0, done.stderr)
        names = sorted(path.name for path in movie.iterdir())
        self.assertEqual(names, [f"{i:06}.png" for i in range(4)])
        self.assertGreater(different(pixels_of(movie / names[0]), pixels_of(movie / names[3])), 400)
        self.assertIn("ffmpeg", done.stdout)
        (movie / "mine.txt").write_text("x")
        self.assertIn("mine.txt", self.refused(REPOSITORY / "meshes/hand.ply", "--movie", movie))

    def test_range_maps_are_shown_as_images_and_surfaces(self):
        maps = self.folder / "maps"
        maps.mkdir()
        for name, file in (("000000.tiff", "truth/duck.tiff"), ("000001.tiff", "truth/flag_a.tiff"), ("rig.yaml", "rig.yaml")):
            (maps / name).write_bytes((REPOSITORY / "demo" / file).read_bytes())
        first = self.picture("first.png", maps, "--seconds", "0")
        second = self.picture("second.png", maps)
        surface = self.picture("surface.png", maps, "--as", "surface", "--seconds", "0")
        same = self.picture("same.png", maps, "--compare", maps, "--show", "difference", "--seconds", "0")
        self.assertGreater(different(first, second), 4000)
        self.assertGreater(different(first, surface), 4000)
        white = int((same == 255).all(axis=2).sum())
        self.assertGreater(white, 8000, "no difference is white")
        self.assertIn("--show: ", self.refused(maps, "--show", "deviation"))

    def test_an_acquisition_shows_its_samples_and_how_they_differ_from_a_model(self):
        plain = self.picture("plain.png", PAGE / "acquisition.db")
        compared = self.picture("compared.png", PAGE / "acquisition.db", "--model", MODEL, "--surface", MODEL / "surface.ply")
        self.assertGreater(int((plain.max(axis=2) < 60).sum()), 100, "dots and arrows")
        self.assertGreater(different(plain, compared), 8000, "surface and other colours")

    def test_without_a_display_there_are_words(self):
        hidden = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
        self.assertIn("no display: DISPLAY is not set", self.refused(MODEL, status=1, environment=hidden))
        gone = {**hidden, "DISPLAY": ":987"}
        self.assertIn("DISPLAY=:987 does not answer", self.refused(MODEL, status=1, environment=gone))
        help_text = subprocess.run([VIEW, "--help"], env=hidden, capture_output=True, text=True, check=True).stdout
        self.assertIn("palpate-view model/", help_text)

    def test_wrong_input_is_refused_with_file_and_what_would_be_right(self):
        damaged, newer = self.folder / "damaged", self.folder / "newer"
        text = (MODEL / "field.json").read_text()
        version = next(word for word in ('"version": 1', '"version":1') if word in text)
        for folder, field in ((damaged, text[:len(text) // 2]), (newer, text.replace(version, '"version": 99', 1))):
            folder.mkdir()
            (folder / "surface.ply").write_bytes((MODEL / "surface.ply").read_bytes())
            (folder / "field.json").write_text(field)
        broken = self.folder / "broken.ply"
        broken.write_bytes((MODEL / "surface.ply").read_bytes()[:5000])
        empty = self.folder / "empty"
        empty.mkdir()
        nobody = self.folder / "other.session"
        nobody.write_text("no session\n")
        for words, told in (
                ((self.folder / "missing",), "missing: there is no such file or folder"),
                ((empty,), "empty: is an empty folder; expected a model"),
                ((damaged,), "damaged/field.json"),
                ((newer,), "newer/field.json"),
                ((broken,), "broken.ply"),
                ((MODEL, "--compare", MODEL), "--compare: is for range maps"),
                ((MODEL, "--trajectory", self.folder / "no.csv"), "no.csv"),
                ((MODEL, "--replay", nobody), "other.session"),
                ((MODEL, "--screenshot", self.folder / "picture.jpg"), "picture.jpg"),
                ((MODEL, "--session", self.folder / "s", "--screenshot", self.folder / "x.png"), "--session: records"),
                ((MODEL, "--screenshto", "x.png"), "did you mean --screenshot?"),
                ((MODEL, "--seconds", "nan"), "--seconds"),
                ((PAGE / "acquisition.db", "--model", empty), "empty"),
                ((), "PATH")):
            with self.subTest(words=words):
                self.assertIn(told, self.refused(*words))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
