# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""build.py REPOSITORY FOLDER: writes the documentation site to FOLDER/html. PYTHONPATH must lead to the built module palpate.

Sphinx makes the pages, their search and the reference of Python; Doxygen makes the reference of C++, in the folder cpp of the site.
Links that lead nowhere, and pages that docs/README.md does not list, are errors.
"""
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from nbconvert import MarkdownExporter

LIBRARIES = ["core", "geometry", "documents", "sensing", "devices", "probing", "acquisition", "haptics", "c"]
PYTHON = """# Python reference

```{eval-rst}
.. automodule:: palpate
   :members:
   :undoc-members:
   :imported-members:
```
"""


def make_cpp_reference(repository, folder):
    """Runs Doxygen; returns the path of its list of all names."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    tags = folder.parent.parent / "tags.xml"
    settings = (repository / "docs/site/Doxyfile").read_text()
    settings += f'OUTPUT_DIRECTORY = "{folder}"\nHTML_OUTPUT = .\nGENERATE_TAGFILE = "{tags}"\n'
    subprocess.run(["doxygen", "-"], cwd=repository, input=settings, text=True, check=True)
    return tags


def cpp_page(tags):
    """The page that leads from the search of the site to the reference of C++: each header with what it declares."""
    lines = ["# C++ and C reference\n", '<a href="../cpp/index.html">Open the full reference</a>, or one header:\n']
    headers = {library: [] for library in LIBRARIES}
    for header in ElementTree.parse(tags).getroot().findall("compound[@kind='file']"):
        path = header.findtext("path", "")
        if "/include/" not in path:
            continue
        names = {name.text.split("::")[-1]: None for name in header.findall("class")}
        names |= {name: None for kind in ("function", "enumeration", "typedef")
                  for name in [member.findtext("name") for member in header.findall(f"member[@kind='{kind}']")] if name}
        headers[path.split("/include/")[0].split("/")[-1]].append(
            f'- <a href="../cpp/{header.findtext("filename")}">{header.findtext("name")}</a>: '
            + ", ".join(f"`{name}`" for name in names))
    for library, lists in headers.items():
        lines += [f"## {library}\n", *sorted(lists), ""]
    return "\n".join(lines)


def stage(repository, folder, tags):
    """The sources of the site: links to the repository, and the pages that are made."""
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "reference").mkdir(parents=True)
    for entry in repository.iterdir():
        if entry.name[0] != "." and entry.name not in ("build", "demo-output"):
            (folder / entry.name).symlink_to(entry)
    for notebook in (repository / "docs/notebooks").glob("*.ipynb"):
        page, resources = MarkdownExporter().from_filename(notebook, {"unique_key": notebook.stem})
        (folder / "notebooks").mkdir(exist_ok=True)
        (folder / "notebooks" / f"{notebook.stem}.md").write_text(page)
        for name, picture in resources["outputs"].items():
            (folder / "notebooks" / name).write_bytes(picture)
    (folder / "reference/python.md").write_text(PYTHON)
    (folder / "reference/cpp.md").write_text(cpp_page(tags))


def mend_theme(static):
    """Debian's theme imports a style sheet from the root of the web server, and a script as only modules may."""
    styles, scripts = static / "styles", static / "scripts"
    shutil.copy("/usr/share/javascript/normalize.css/normalize.css", styles)
    for path, old, new in ((styles / "furo.css", "url(/javascript/normalize.css/normalize.css)", "url(normalize.css)"),
                           (scripts / "furo.js", 'import Gumshoe from "./gumshoe-patched.js";',
                            (scripts / "gumshoe-patched.js").read_text())):
        text = path.read_text()
        if old not in text:
            raise SystemExit(f"{path}: has no {old}: the theme has changed")
        path.write_text(text.replace(old, new))


def main(repository, folder):
    tags = make_cpp_reference(repository, folder / "doxygen/cpp")
    stage(repository, folder / "pages", tags)
    shutil.rmtree(folder / "html", ignore_errors=True)
    (folder / "doxygen/index.html").write_text('<meta http-equiv="refresh" content="0; url=README.html">')
    status = subprocess.run([sys.executable, "-B", "-m", "sphinx", "-q", "-W", "--keep-going", "-c", repository / "docs/site",
                             "-D", f"html_extra_path={folder / 'doxygen'}", "-d", folder / "doctrees", folder / "pages",
                             folder / "html"]).returncode
    mend_theme(folder / "html/_static")
    return status


if __name__ == "__main__":
    sys.exit(main(*(Path(argument).resolve() for argument in sys.argv[1:])))
