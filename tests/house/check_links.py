# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""check_links.py REPOSITORY: each relative link of its Markdown pages leads to a file, and to a heading of it."""
import re
import subprocess
import sys
from pathlib import Path


def anchors_of(text):
    """The anchors that GitHub gives the headings of a page."""
    anchors = set()
    for heading in re.findall(r"^#+ +(.*?) *#*$", without_code(text), re.M):
        words = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        anchor = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
        name, number = anchor, 0
        while name in anchors:
            number += 1
            name = f"{anchor}-{number}"
        anchors.add(name)
    return anchors


def without_code(text):
    return re.sub(r"^ *```.*?^ *```", "", text, flags=re.M | re.S)


def check(pages, exists):
    """The problems of `pages`, path -> text; `exists` tells whether another path does."""
    problems = []
    for page, text in pages.items():
        for link in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`\n]*`", "", without_code(text))):
            if re.match(r"\w+:", link):
                continue
            path, _, anchor = link.partition("#")
            target = (Path("/") / page.parent / path).resolve().relative_to("/") if path else page
            if not (target in pages or exists(target)):
                problems.append(f"{page}: links to {link}, which does not exist")
            elif anchor and anchor not in anchors_of(pages.get(target, "")):
                problems.append(f"{page}: links to {link}, which has no such heading")
    return problems


def main(root):
    names = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"], cwd=root, check=True,
                           capture_output=True, text=True).stdout.split()
    pages = {Path(name): (root / name).read_text() for name in names if (root / name).exists()}
    problems = check(pages, lambda path: (root / path).exists())
    print("\n".join(problems) or f"{len(pages)} pages")
    return bool(problems) or not pages


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
