# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""documented_commands.py PALPATE PAGE...: what the pages show runs on the bundled data.

Of each page, the lines `palpate ...` of the blocks ```sh are run from top to bottom, in a folder that has nothing but the bundled
data; each must end with status 0. The blocks ```python are run too, where Python finds the module palpate. Other lines of blocks
```sh must be among those of `OTHERS`: a command that needs data which are not bundled belongs into a block ```console.
"""
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RUN = ("palpate ", "echo ", "cmp ", "cat > ")
OTHERS = ("./dev ", 'export PATH="$PWD/build/release/apps/palpate:$PATH"')


def blocks_of(text):
    """(language, code) of the blocks, as they stand."""
    return [(language, code) for language, code in re.findall(r"^```(\w+)\n(.*?)^```", text, re.M | re.S)
            if language in ("sh", "python")]


def commands_of(code):
    """The commands of a block ```sh that are run, with their here-documents, and the lines that must not be there."""
    lines = re.findall(r"^(?!#).* << '?EOF'?\n(?:.*\n)*?EOF$|^(?!#).+$", code.replace("\\\n", " "), re.M)
    run = [line for line in lines if line.startswith(RUN)]
    return run, [line for line in lines if not line.startswith(RUN + OTHERS)]


def problems_of(page, palpate):
    """What went wrong on a page, and the number of commands that were run."""
    problems, count = [], 0
    environment = dict(os.environ, PATH=f"{palpate.parent}{os.pathsep}{os.environ['PATH']}", MPLBACKEND="Agg")
    with tempfile.TemporaryDirectory() as folder:
        for name in ("demo", "meshes"):
            shutil.copytree(ROOT / name, Path(folder) / name)

        def run(words, shown, **options):
            begin = time.monotonic()
            done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, **options)
            print(f"  {time.monotonic() - begin:6.1f} s  {shown.splitlines()[0]}", flush=True)
            if done.returncode:
                problems.append(f"{page}: ends with status {done.returncode}: {shown}\n{done.stdout}{done.stderr}")

        for language, code in blocks_of((ROOT / page).read_text()):
            if language == "python":
                if importlib.util.find_spec("palpate"):
                    run([sys.executable, "-B", "-c", code], "python: " + code.strip().split("\n")[-1])
                    count += 1
                continue
            commands, others = commands_of(code)
            problems += [f"{page}: cannot be run on the bundled data: {line}" for line in others]
            for command in commands:
                run(["bash", "-c", command], command)
                count += 1
    return problems, count


def main(palpate, pages):
    problems = []
    for page in pages:
        print(page, flush=True)
        found, count = problems_of(page, palpate)
        problems += found if count else found + [f"{page}: has no command that runs"]
    print("\n".join(problems))
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), sys.argv[2:]))
