# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""check_site.py REPOSITORY FOLDER: builds the documentation site in FOLDER; the navigation has every page, the references every name
of the module and every public header, and no page loads anything from elsewhere."""
import html.parser
import re
import subprocess
import sys
from pathlib import Path

import palpate

NO_PAGES = ("tests/", ".github/")  # notes beside data; forms of a web site


class Elements(html.parser.HTMLParser):
    """The ids of a page, the links in its navigation, and what it loads."""

    def __init__(self, path):
        super().__init__()
        self.ids, self.navigation, self.loads = set(), set(), []
        self.within = 0
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.ids.add(values.get("id"))
        if tag == "div" and (self.within or "sidebar-tree" in (values.get("class") or "")):
            self.within += 1
        if tag == "a" and self.within:
            self.navigation.add(values.get("href"))
        if tag in ("script", "img", "iframe", "source"):
            self.loads.append(values.get("src") or "")
        if tag == "link":
            self.loads.append(values.get("href") or "")

    def handle_endtag(self, tag):
        if tag == "div" and self.within:
            self.within -= 1


def main(repository, folder):
    subprocess.run([sys.executable, "-B", repository / "docs/site/build.py", repository, folder], check=True)
    site = folder / "html"
    names = subprocess.run(["git", "ls-files", "*.md", "*.ipynb", "*/include/*.h"], cwd=repository, check=True, capture_output=True,
                           text=True).stdout.split()
    pages = [name for name in names if name.endswith(".md") and not name.startswith((*NO_PAGES, "docs/site/"))]
    pages += [f"notebooks/{Path(name).stem}.md" for name in names if name.endswith(".ipynb")]
    first = Elements(site / "README.html")
    problems = [f"{page}: is not in the navigation" for page in pages
                if page != "README.md" and page.removesuffix(".md") + ".html" not in first.navigation]
    documented = Elements(site / "reference/python.html").ids
    problems += [f"palpate.{name}: is not in the reference" for name in dir(palpate)
                 if not name.startswith("_") and f"palpate.{name}" not in documented]
    headers = re.findall(r'href="\.\./(cpp/\w+\.html)">(\w+\.h)<', (site / "reference/cpp.html").read_text())
    listed = {header for page, header in headers if (site / page).exists()}
    problems += [f"{name}: is not in the reference" for name in names
                 if name.endswith(".h") and not name.startswith("apps/") and Path(name).name not in listed]
    for path in site.rglob("*.html"):
        problems += [f"{path}: loads {load}" for load in Elements(path).loads if re.match(r"(\w+:)?/", load)]
    for path in site.rglob("*.css"):
        problems += [f"{path}: loads {load}" for load in re.findall(r"""url\(["']?((?:\w+:)?/[^)"']*)""", path.read_text())]
    print("\n".join(problems) or f"{len(pages)} pages, {len(listed)} headers")
    return bool(problems) or not pages or not listed


if __name__ == "__main__":
    sys.exit(main(*(Path(argument).resolve() for argument in sys.argv[1:])))
