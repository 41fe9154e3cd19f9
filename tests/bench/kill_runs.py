#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Kills palpate at random moments (SIGKILL) and checks what it leaves.

After each kill, a reader of the output must find the results of the earlier run as a whole, or those of the killed run
as a whole; while one replaces the other, the marker that keeps readers away must be there. A file is never a part of
one. Where there was no earlier run, the files that are there must be whole. Then the same call must succeed, give what
a run gives that was never killed, and leave nothing else.
"""
import argparse
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
DEMO = REPOSITORY / "demo"
REPLACING = {".palpate-finished", ".palpate-placing"}


class Wrong(Exception):
    """What was found is not what must be."""


class Command:
    """A command with two versions of its call, whose results differ, and whose output lies in `work`/out."""

    resumes = False

    def __init__(self, palpate, work):
        self.palpate = palpate
        self.work = work
        self.out = work / "out"
        self.out.mkdir(parents=True)
        self.prepare()

    def run(self, *words):
        return subprocess.run([self.palpate, *map(str, words)], capture_output=True, text=True, check=False)

    def run_whole(self, version, *more):
        done = self.run(*self.call(version), *more)
        if done.returncode != 0:
            raise Wrong(f"exit status {done.returncode} instead of 0: {done.stderr.strip()}")

    def kill_after(self, version, seconds):
        """Whether the run was killed before it ended."""
        words = [self.palpate, *map(str, self.call(version))]
        with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            try:
                process.wait(seconds)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
            return process.wait() == -signal.SIGKILL

    def visible(self):
        """What readers find: all files that are not hidden, nor in a hidden folder, with their content."""
        files = {}
        for path in sorted(self.out.rglob("*")):
            name = path.relative_to(self.out)
            if path.is_file() and not any(part.startswith(".") for part in name.parts):
                files[str(name)] = self.content(path)
        return files

    def hidden(self):
        return {path.name for path in self.out.rglob(".*")}

    @staticmethod
    def content(path):
        content = path.read_bytes()
        if path.suffix == ".jsonl":  # how long a frame took is another number each time
            content = re.sub(rb'"ms":[^,}]*', b"", content)
        return content


class Decode(Command):
    resumes = True

    def prepare(self):
        frames = self.work / "frames"
        frames.mkdir()
        for i in range(3):
            shutil.copy(DEMO / "frames/flag_a.png", frames / f"{i}.png")
        self.run("calibrate", "colors", DEMO / "training", "-o", self.work / "colors.yaml")

    def call(self, version):
        return ["decode", self.work / "frames", "--rig", DEMO / "rig.yaml", "--pattern", DEMO / "pattern.yaml",
                "--colors", self.work / "colors.yaml", "--sigma", "--window", 2 + version, "-o", self.out / "range"]


class Mesh(Command):
    def prepare(self):
        maps = self.work / "range"
        maps.mkdir()
        for name in ("flag_a", "flag_b", "duck"):
            shutil.copy(DEMO / f"truth/{name}.tiff", maps)
        shutil.copy(DEMO / "rig.yaml", maps)

    def call(self, version):
        return ["mesh", self.work / "range", "--smooth", 1 + version, "-o", self.out / "meshes"]


class Import(Command):
    def prepare(self):
        pass

    def call(self, version):
        data = DEMO / ("sheet", "sheet_block")[version]
        return ["probe", "import", data / "contacts.csv", data / "samples.csv", "-o", self.out / "a.db"]


class Fit(Command):
    resumes = True

    def prepare(self):
        data = DEMO / "sheet"
        self.run("probe", "import", data / "contacts.csv", data / "samples.csv", "-o", self.work / "a.db")

    def call(self, version):
        return ["fit", self.work / "a.db", DEMO / "sheet/surface.ply", "--max-bases", 1 + version,
                "-o", self.out / "model"]

    def visible(self):
        # Finished fits, which are kept until the model is written.
        return {name: content for name, content in super().visible().items() if name != "model.fits"}


class Export(Command):
    def prepare(self):
        self.run(*Fit.call(self.fit(), 0))
        self.run(*Fit.call(self.fit(), 1))

    def fit(self):
        raise NotImplementedError

    def call(self, version):
        return ["export", self.work / f"model{version}", "--json", "-o", self.out / "model.json"]


def main():
    pass
