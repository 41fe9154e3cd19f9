#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Measures what shards cost: the tables of docs/clusters.md.

    python3 -B studies/shard_overhead.py build/release/apps/palpate/palpate [FRAMES]

Times are those of the processor, in one thread, so that other programs on the computer change them little.
"""
import json
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

DEMO = Path(__file__).resolve().parents[1] / "demo"
PICTURES = ("flag_a.png", "flag_b.png", "duck.png", "plane.png")


class Study:
    def __init__(self, palpate, work):
        self.palpate = palpate
        self.work = work
        self.run("calibrate", "colors", DEMO / "training", "-o", "colors.yaml")

    def run(self, *words):
        """Runs palpate, and returns the seconds of the processor."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([self.palpate, *map(str, words), "-q"], cwd=self.work, check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def link_frames(self, folder, count):
        """Hard links, which cost a program what files of their own cost. File systems allow some 65,000 links of a file."""
        (self.work / folder).mkdir()
        for name in PICTURES:
            shutil.copy(DEMO / "frames" / name, self.work / f"{folder}-{name}")
        for number in range(count):
            (self.work / folder / f"{number}.png").hardlink_to(self.work / f"{folder}-{PICTURES[number % len(PICTURES)]}")

    def decode(self, frames, output, shard=None):
        more = [] if shard is None else ["--shard", shard]
        return self.run("decode", frames, "--rig", DEMO / "rig.yaml", "--pattern", DEMO / "pattern.yaml", "--colors",
                        "colors.yaml", "-o", output, "--threads", 1, *more)

    def bytes_of(self, pattern):
        return sum(path.stat().st_size for path in self.work.glob(pattern))

    def peak_memory(self, output):
        """[MB] The largest of all shards."""
        return max(json.loads(path.open().readline())["peak_memory"]
                   for path in (self.work / output / "shards").glob("*.jsonl")) / 1e6


REPEATS = 3  # the least of these is taken


def one_shard(study, frames):
    study.link_frames("frames", frames)
    whole = min(study.decode("frames", f"serial{i}") for i in range(REPEATS))
    shard = min(study.decode("frames", f"shard{i}", "1/1") for i in range(REPEATS))
    merge = study.run("merge-shards", "shard0")
    journal, maps = study.bytes_of("shard0/shards/*.jsonl"), study.bytes_of("shard0/*.tiff")
    print("| | |\n|---|---|")
    print(f"| {frames} frames without `--shard` | {whole:.2f} s, {1e3 * whole / frames:.1f} ms a frame |")
    print(f"| as one shard | {shard:.2f} s, {100 * (shard / whole - 1):.1f} % more |")
    print(f"| merge | {merge:.2f} s |")
    print(f"| journal | {journal / frames / 1e3:.1f} kB a frame, {100 * journal / maps:.2f} % of the range maps |")
    print(f"| peak memory of the shard | {study.peak_memory('shard0'):.0f} MB |")


def start_of_a_shard(study):
    print("\n| frames in the folder | a shard without frames |\n|---|---|")
    for count in (100, 10_000, 100_000):
        folder = f"links{count}"
        study.link_frames(folder, count)
        # Of more shards than frames, the first one is empty.
        taken = min(study.decode(folder, f"empty{count}-{i}", f"1/{2 * count}") for i in range(REPEATS))
        print(f"| {count:,} | {taken:.2f} s |")


def main():
    frames = int(sys.argv[2]) if len(sys.argv) > 2 else 100
    with tempfile.TemporaryDirectory(prefix="palpate-shards-") as work:
        study = Study(str(Path(sys.argv[1]).resolve()), Path(work))
        one_shard(study, frames)
        start_of_a_shard(study)


if __name__ == "__main__":
    main()
