# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""check_readme.py REPOSITORY: each block of C++ in README.md stands, line by line, in one of apps/examples, which are
compiled and run; and each file of the repository that it links to exists."""
import re
import sys
from pathlib import Path


def check(readme, examples, exists):
    """The problems of the text `readme`; `examples` are texts, `exists` tells whether a path does."""
    problems = []
    for block in re.findall(r"```cpp\n(.*?)```", readme, re.DOTALL):
        if not any(block in example for example in examples):
            problems.append("README.md: no file of apps/examples contains this block:\n" + block)
    for link in re.findall(r"\]\(([^)#]+)", readme):
        if "://" not in link and not exists(link):
            problems.append(f"README.md: links to {link}, which does not exist")
    return problems


def main(root):
    examples = [path.read_text() for path in sorted((root / "apps/examples").glob("*.cpp"))]
    problems = check((root / "README.md").read_text(), examples, lambda link: (root / link).exists())
    print("\n".join(problems))
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
