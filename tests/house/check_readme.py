# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""check_readme.py REPOSITORY: README.md is one page, and each block of C++ in it and in docs/linking.md stands, line by line,
in one of apps/examples, which are compiled and run."""
import re
import sys
from pathlib import Path

MOST_WORDS = 900


def check_blocks(name, text, examples):
    """The problems of a page; `examples` are texts."""
    return [f"{name}: no file of apps/examples contains this block:\n" + block
            for block in re.findall(r"```cpp\n(.*?)```", text, re.DOTALL)
            if not any(block in example for example in examples)]


def check_length(text):
    count = len(text.split())
    return [] if count <= MOST_WORDS else [f"README.md: has {count} words, at most {MOST_WORDS} are one page"]


def main(root):
    examples = [path.read_text() for path in sorted((root / "apps/examples").glob("*.cpp"))]
    problems = check_length((root / "README.md").read_text())
    for name in ("README.md", "docs/linking.md"):
        problems += check_blocks(name, (root / name).read_text(), examples)
    print("\n".join(problems))
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
