#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Decodes a sequence on a cluster of Slurm, by Snakemake and by GNU parallel, and compares with one run, to the byte.

On Slurm, the shards are submitted as two arrays by cluster/submit.sh. While a shard runs on the first node, that node is
killed with all its processes (SIGKILL), and comes back later; its shard must be done again. Then the shards are merged.

A project is run on this machine, and by `palpate run --executor slurm`. One of its shards is cancelled; a second call does it.

    tests/cluster/cluster_test.py PALPATE
"""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from slurm import Cluster, missing, wait_for

REPOSITORY = Path(__file__).resolve().parents[2]
DEMO = REPOSITORY / "demo"
FRAMES = 180
PROJECT_FRAMES = 40
SHARDS = 6


class Wrong(Exception):
    """What was found is not what must be."""


class Sequence:
    """Frames in a folder, and calls that decode them."""

    def __init__(self, palpate, work):
        self.work = work
        self.environment = dict(os.environ, PATH=f"{palpate.parent}:{os.environ['PATH']}")
        for folder, count in (("frames", FRAMES), ("project-frames", PROJECT_FRAMES)):
            (work / folder).mkdir()
            for number in range(count):
                (work / folder / f"{number}.png").symlink_to(DEMO / "frames" / ("flag_a.png", "flag_b.png")[number % 2])
        self.run("palpate", "calibrate", "colors", DEMO / "training", "-o", "colors.yaml")
        self.run(*self.call("serial"), "--threads", "1")

    @staticmethod
    def call(output):
        return ["palpate", "decode", "frames", "--rig", str(DEMO / "rig.yaml"), "--pattern", str(DEMO / "pattern.yaml"),
                "--colors", "colors.yaml", "-o", output]

    def run(self, *words, environment=None):
        done = subprocess.run([str(word) for word in words], cwd=self.work, env=environment or self.environment,
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Wrong(f"{' '.join(map(str, words))}: exit status {done.returncode}: {done.stdout}{done.stderr}")
        return done.stdout

    def results(self, output):
        """The files of a folder of results with their content, without journals and the times of frames."""
        files = {path.name: path.read_bytes() for path in (self.work / output).iterdir() if path.is_file()}
        if "decode.jsonl" in files:
            files["decode.jsonl"] = re.sub(rb'"ms":[^,]*,', b"", files["decode.jsonl"])
        return files

    def compare(self, output, with_output="serial"):
        expected, found = self.results(with_output), self.results(output)
        if expected.keys() != found.keys():
            raise Wrong(f"{output}: other files than of one run: {sorted(expected.keys() ^ found.keys())}")
        different = [name for name in expected if expected[name] != found[name]]
        if different:
            raise Wrong(f"{output}: other content than of one run: {different}")

    def journals(self, output):
        return sorted(path.name for path in (self.work / output / "shards").glob("*.jsonl"))


def environment_of(cluster, sequence):
    environment = dict(cluster.environment, PALPATE_ARRAY="4", PALPATE_MEMORY="200M", PALPATE_TIME="5")
    environment["PATH"] = f"{sequence.environment['PATH']}:{environment['PATH']}"
    return environment


def on_slurm(sequence):
    with tempfile.TemporaryDirectory(prefix="palpate-slurm-") as folder, Cluster(Path(folder)) as cluster:
        environment = dict(environment_of(cluster, sequence), PALPATE_LOGS=folder)
        jobs = sequence.run(REPOSITORY / "cluster" / "submit.sh", SHARDS, *sequence.call("slurm"), environment=environment)

        def begun_on(node):
            """A job that has begun to write range maps."""
            jobs = cluster.call("squeue", "-h", "-t", "running", "-w", node, "-o", "%A %K").splitlines()
            for job, shard in map(str.split, jobs):
                if (sequence.work / "slurm" / f"{(int(shard) - 1) * FRAMES // SHARDS:06}.tiff").exists():
                    return job, f"{int(shard):04}-of-{SHARDS:04}.jsonl"
            return None

        wait_for(lambda: begun_on("first"), "a shard on the first node")
        killed, journal = begun_on("first")
        cluster.kill_node("first")
        if journal in sequence.journals("slurm"):
            raise Wrong(f"{journal} was written before its node was killed")
        state = cluster.call("scontrol", "-o", "show", "job", killed)
        if "Restarts=1" not in state:
            raise Wrong(f"the shard of the killed node was not queued again: {state}")
        cluster.start_node("first")
        sequence.run("sbatch", f"--dependency=afterok:{jobs.strip()}", f"--output={folder}/merge.log", "--wait", "--wrap",
                     "exec palpate merge-shards slurm --verify", environment=environment)
        sequence.compare("slurm")
        return f"{journal} was begun on a node that was killed, and done again"


def project_on_slurm(sequence):
    (sequence.work / "project.yaml").write_text(f"""\
decode: {{frames: project-frames, rig: {DEMO}/rig.yaml, pattern: {DEMO}/pattern.yaml, colors: colors.yaml}}
mesh:   {{range: range, output: meshes}}
""", encoding="utf-8")
    here = ["palpate", "run", "project.yaml", "-o", "here"]
    there = ["palpate", "run", "project.yaml", "-o", "on slurm", "--shards", SHARDS, "--executor", "slurm"]
    sequence.run(*here)
    with tempfile.TemporaryDirectory(prefix="palpate-slurm-") as folder, Cluster(Path(folder)) as cluster:
        environment = environment_of(cluster, sequence)
        with subprocess.Popen([str(word) for word in there], cwd=sequence.work, env=environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            # The second array has the shards 5 and 6; a new controller counts jobs from 1.
            wait_for(lambda: "2_2" in cluster.call("squeue", "-h", "-r", "-t", "pending", "-o", "%i").split(),
                     "the last shard in the queue")
            cluster.call("scancel", "2_2")
            _out, err = run.communicate(timeout=100)
        if run.returncode != 1 or f"1 of {SHARDS} shards failed on Slurm: {SHARDS}" not in err:
            raise Wrong(f"the shard that was cancelled is not told, with status {run.returncode}: {err}")
        lost = sequence.work / "on slurm" / "range" / "shards" / f"{SHARDS:04}-of-{SHARDS:04}.jsonl"
        if lost.exists():
            raise Wrong("the shard was done before it was cancelled")
        times = {path: path.stat().st_mtime_ns for path in lost.parent.glob("*.jsonl")}
        sequence.run(*there, environment=environment)
        logs = list((sequence.work / "on slurm" / "project.logs" / "decode").glob("palpate-*.log"))
        if len(logs) != SHARDS:
            raise Wrong(f"{len(logs)} logs of {SHARDS} shards")
        if any(path.stat().st_mtime_ns != time for path, time in times.items()):
            raise Wrong("shards were done again that were finished")
    for results in ("range", "meshes"):
        sequence.compare(f"on slurm/{results}", f"here/{results}")
    records = [json.loads((sequence.work / output / "project.run").read_text(encoding="utf-8"))["steps"]
               for output in ("here", "on slurm")]
    for step in ("decode", "mesh"):
        prints = [{Path(path).name: text for path, text in record[step]["outputs"].items()} for record in records]
        if prints[0] != prints[1]:
            raise Wrong(f"{step}: other fingerprints on Slurm than here")
    return f"{len(times)} of {SHARDS} shards at first, the one that was cancelled by a second call"


def by_snakemake(sequence):
    call = ["snakemake", "-s", REPOSITORY / "cluster" / "Snakefile", "--cores", 2, "--config", f"shards={SHARDS}",
            "output=snakemake", f"call={' '.join(sequence.call('snakemake'))}"]
    sequence.run(*call)
    lost = sequence.work / "snakemake" / "shards" / f"0002-of-{SHARDS:04}.jsonl"
    times = {name: (lost.parent / name).stat().st_mtime_ns for name in sequence.journals("snakemake")}
    lost.unlink()
    (lost.parent / "merged").unlink()
    sequence.run(*call)
    sequence.compare("snakemake")
    again = [name for name, time in times.items() if (lost.parent / name).stat().st_mtime_ns != time]
    if again != [lost.name]:
        raise Wrong(f"without {lost.name}, these shards were done again: {again}")
    return "a shard without journal was done again, and no other"


def by_parallel(sequence):
    sequence.run(REPOSITORY / "cluster" / "parallel.sh", SHARDS, *sequence.call("parallel"))
    sequence.run("palpate", "merge-shards", "parallel")
    sequence.compare("parallel")
    # A list of finished jobs from another command must not hide these.
    sequence.run(REPOSITORY / "cluster" / "parallel.sh", SHARDS, "palpate", "mesh", "parallel", "-o", "parallel-meshes")
    if len(sequence.journals("parallel-meshes")) != SHARDS:
        raise Wrong("a second command in the same folder made no shards")
    return f"{len(sequence.journals('parallel'))} journals, and as many of a second command"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("palpate", type=Path)
    palpate = parser.parse_args().palpate.resolve()
    failures = 0
    with tempfile.TemporaryDirectory(prefix="palpate-cluster-") as work:
        sequence = Sequence(palpate, Path(work))
        for name, test, reason in (("slurm", on_slurm, missing()),
                                   ("project on slurm", project_on_slurm, missing()),
                                   ("snakemake", by_snakemake, shutil.which("snakemake") is None and "snakemake missing"),
                                   ("parallel", by_parallel, shutil.which("parallel") is None and "parallel missing")):
            if reason:
                print(f"{name}: skipped: {reason}")
                continue
            try:
                found = test(sequence)
                print(f"{name}: as one run, to the byte; {found}")
            except (Wrong, RuntimeError, TimeoutError) as wrong:
                print(f"{name}: {wrong}", file=sys.stderr)
                failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
