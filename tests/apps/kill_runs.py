#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Kills palpate at random moments (SIGKILL) and checks what it leaves.

After each kill, a reader of the output must find the results of the earlier run as a whole, or those of the killed run
as a whole; while one replaces the other, the marker that keeps readers away must be there. A file is never a part of
one. Where there was no earlier run, the files that are there must be whole. Then the same call, or its continuation,
must succeed, give what a run gives that was never killed, and leave nothing else.

A campaign of `probe run` is killed, resumed and killed again until it ends, and then started again, until the given number of
runs was killed at work. After each kill, all trials that a reader saw before must be there, and what is there must be, to the last
bit, what a campaign that was never killed stored up to there: nothing but the trial in flight is lost.

A campaign on a file system that becomes full (a small tmpfs, in a mount namespace of its own) must end with a message
that names the store and the cause, and measure the same once there is room.
"""
import argparse
import contextlib
import json
import random
import re
import shutil
import signal
import sqlite3
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
        for i in range(2):
            shutil.copy(DEMO / "frames/flag_a.png", frames / f"{i}.png")
        self.run("calibrate", "colors", DEMO / "training", "-o", self.work / "colors.yaml")

    def call(self, version):
        return ["decode", self.work / "frames", "--rig", DEMO / "rig.yaml", "--pattern", DEMO / "pattern.yaml",
                "--colors", self.work / "colors.yaml", "--sigma", "--window-periods", 2 + version, "-o", self.out / "range"]


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
        self.run("probe", "import", *self.few_contacts(), "-o", self.work / "a.db")

    def few_contacts(self):
        """Every third contact of the sheet and its samples, so that a fit takes a second."""
        for name, column in (("contacts", 0), ("samples", 1)):
            head, *rows = (DEMO / f"sheet/{name}.csv").read_text().splitlines()
            kept = [row for row in rows if int(row.split(",")[column]) % 3 == 0]
            path = self.work / f"{name}.csv"
            path.write_text("\n".join([head, *kept]) + "\n")
            yield path

    def call(self, version):
        return self.fit(version, self.out / "model")

    def fit(self, version, output):
        options = (["--max-bases", 1, "--passive", "local"], [])[version]  # both are quick
        return ["fit", self.work / "a.db", DEMO / "sheet/surface.ply", *options, "-o", output]

    def visible(self):
        # The record of finished fits is no result; it goes when the model is written.
        return {name: content for name, content in super().visible().items() if name != "model.fits"}


class Export(Fit):
    resumes = False

    def prepare(self):
        super().prepare()
        for version in (0, 1):
            self.run(*self.fit(version, self.work / f"model{version}"))

    def call(self, version):
        return ["export", self.work / f"model{version}", "--json", "-o", self.out / "model.json"]


class Probe(Command):
    """A campaign, whose store is not replaced but resumed."""

    def prepare(self):
        specimen = self.work / "sheet.json"
        specimen.write_text('{"type": "sheet"}\n')
        self.figures("probe", "plan", "--specimen", specimen, "--contacts", 8, "-o", self.work / "plan.json", "--json")
        self.store = self.out / "a.db"

    def call(self, version):
        if version == "resume":
            return ["probe", "resume", self.store, "--json"]
        return ["probe", "run", self.work / "plan.json", "--specimen", self.work / "sheet.json", "-o", self.store,
                "--json"]

    def figures(self, *words):
        done = self.run(*words)
        if done.returncode != 0:
            raise Wrong(f"exit status {done.returncode} instead of 0: {done.stderr.strip()}")
        return json.loads(done.stdout)

    def rows(self):
        """Trials and samples as they are stored. None if the run was killed before there was a store."""
        if not self.store.exists():
            return None
        with contextlib.closing(sqlite3.connect(f"file:{self.store}?mode=ro", uri=True)) as store:
            # Whether a sample is on the boundary of friction is known later.
            return (store.execute("SELECT * FROM trial ORDER BY id").fetchall(),
                    store.execute("SELECT id, contact, group_id, px, py, pz, ax, ay, az, bx, by, bz, slipped, time"
                                  " FROM sample ORDER BY id").fetchall())

    def killed_after(self, version, seconds):
        """Whether the run was killed before it ended, and how many trials a reader saw just before."""
        words = [self.palpate, *map(str, self.call(version))]
        with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            try:
                process.wait(seconds)
            except subprocess.TimeoutExpired:
                pass
            seen = self.rows()
            process.send_signal(signal.SIGKILL)
            return process.wait() == -signal.SIGKILL, len(seen[0]) if seen else 0

    def check(self, kills, moments):
        """Kills this number of runs at work. Returns their number, and that of the campaigns they were of."""
        start = time.monotonic()
        whole = self.figures(*self.call("run"))
        seconds = time.monotonic() - start
        trials, samples = self.rows()
        killed, campaigns, here = 0, 0, None
        while killed < kills:
            if here is None or here == len(trials):
                shutil.rmtree(self.out)
                self.out.mkdir()
                campaigns += 1
                here = None
            was_killed, seen = self.killed_after("run" if here is None else "resume", moments.uniform(0, seconds / 4))
            killed += was_killed
            found = self.rows()
            if found is None:
                continue
            if len(found[0]) < seen:
                raise Wrong(f"{seen} trials were stored, and {len(found[0])} after the kill")
            if found[0] != trials[: len(found[0])] or found[1] != samples[: len(found[1])]:
                raise Wrong("the trials after a kill are not those of a campaign that was never killed")
            if len(found[1]) != sum(trial[0] <= found[0][-1][0] for trial in samples) if found[0] else found[1]:
                raise Wrong("a trial was stored without its sample")
            here = len(found[0])
        found = self.figures(*self.call("run" if here is None else "resume"))
        if (found["fingerprint"], found["trials"]) != (whole["fingerprint"], whole["trials"]):
            raise Wrong("the samples are not those of a campaign that was never killed")
        return f"{killed} runs of {campaigns} campaigns of {len(trials)} trials killed at work"


class FullDisk(Probe):
    """The same campaign on a file system that becomes full, and then gets room."""

    SCRIPT = """mount -t tmpfs -o size=500k palpate "$1" || exit 77
shift; room=$1; shift
"$@" >/dev/null; echo $? >"$room/status"
mount -o remount,size=16m "$(dirname "$STORE")" && "$1" probe resume "$STORE" --json"""

    def check(self, _kills, _moments):
        whole = self.figures(*self.call("run"))
        shutil.rmtree(self.out)
        self.out.mkdir()
        done = subprocess.run(
            ["unshare", "--mount", "--map-root-user", "sh", "-c", self.SCRIPT, "sh", self.out, self.work, self.palpate,
             *map(str, self.call("run"))], capture_output=True, text=True, check=False,
            env={"STORE": str(self.store), "PATH": "/usr/sbin:/usr/bin:/sbin:/bin"})
        status = self.work / "status"
        if not status.exists():
            raise Wrong(f"a small file system cannot be made here: {done.stderr.strip()}")
        ended = status.read_text().strip()
        said = [line for line in done.stderr.splitlines() if str(self.store) in line and "full" in line]
        if ended != "1" or not said:
            raise Wrong(f"exit status {ended} on a full disk: {done.stderr.strip()}")
        found = json.loads(done.stdout)
        if (found["fingerprint"], found["trials"]) != (whole["fingerprint"], whole["trials"]):
            raise Wrong("the samples are not those of a campaign that always had room")
        return f"{said[0]}; then there was room"


COMMANDS = {kind.__name__.lower(): kind for kind in (Decode, Mesh, Import, Fit, Export, Probe, FullDisk)}


def check_killed(command, before, after):
    """Checks what a reader finds after a kill of the run that turns the results `before` into `after`."""
    found = command.visible()
    if found in (before, after):
        return
    if before and not command.hidden() & REPLACING:
        raise Wrong("the results are neither those of the earlier run nor those of the killed one")
    for name, content in found.items():
        # The record of a run that had nothing to replace grows with its frames.
        grows = not before and name.endswith(".jsonl") and after[name].startswith(content)
        if content not in (before.get(name), after.get(name)) and not grows:
            raise Wrong(f"{name} is neither the file of the earlier run nor that of the killed one")


def check_whole(command, after):
    if command.visible() != after:
        raise Wrong("the results are not those of a run that was never killed")
    left = [str(path) for path in command.work.rglob(".*")] + [str(path) for path in command.work.rglob("*.fits")]
    if left:
        raise Wrong(f"left over: {', '.join(left)}")


def check_command(command, kills, moments):
    """Kills the command this number of times. Returns how many of the runs were still at work."""
    results, seconds = [], 0
    for version in (0, 1):
        start = time.monotonic()
        command.run_whole(version)
        seconds = max(seconds, time.monotonic() - start)
        results.append(command.visible())
    if results[0] == results[1]:
        raise Wrong("the two versions give the same, so nothing can be told")
    killed, now = 0, 1
    for kill in range(kills):
        if kill % 4 == 3:
            shutil.rmtree(command.out)
            command.out.mkdir()
            before = {}
        else:
            before = results[now]
        now = 1 - now
        killed += command.kill_after(now, moments.uniform(0, seconds))
        check_killed(command, before, results[now])
        # Continued, if there is something to continue: settings that differ from those of the results are refused.
        if command.resumes and kill % 2 == 0:
            resumed = command.run(*command.call(now), "--resume")
            if resumed.returncode not in (0, 2):
                raise Wrong(f"--resume: exit status {resumed.returncode}: {resumed.stderr.strip()}")
            if resumed.returncode == 0:
                check_whole(command, results[now])
                continue
        command.run_whole(now)
        check_whole(command, results[now])
    return killed


def check(command, kills, moments):
    """Returns what was done, in words."""
    if isinstance(command, Probe):
        return command.check(kills, moments)
    return f"{kills} runs, {check_command(command, kills, moments)} of them killed at work"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("palpate", help="the program")
    parser.add_argument("--kills", type=int, default=100, help="of each command (default: 100)")
    parser.add_argument("--seed", type=int, default=1, help="of the moments (default: 1)")
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=list(COMMANDS))
    call = parser.parse_args()
    status = 0
    for name in call.commands:
        with tempfile.TemporaryDirectory() as work:
            try:
                done = check(COMMANDS[name](call.palpate, Path(work)), call.kills, random.Random(call.seed))
                print(f"{name}: {done}: nothing lost", flush=True)
            except Wrong as wrong:
                print(f"{name}: {wrong}", flush=True)
                status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
