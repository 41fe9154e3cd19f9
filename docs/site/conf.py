# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""How Sphinx makes the site: README.md is its first page, and docs/README.md gives the navigation."""
import gc
import re
from pathlib import Path

from pygments.lexers import TextLexer

# Of a million nodes of the pages, all of which stay, Python would look for unused ones after each 700 new ones: 40 % of the time.
gc.set_threshold(1_000_000)

project = "Palpate"
html_title = "Palpate"
root_doc = "README"
include_patterns = ["*.md", "docs/*.md", "demo/README.md", "meshes/README.md", "notebooks/*.md", "reference/*.md"]
extensions = ["myst_parser", "sphinx.ext.autodoc"]
myst_heading_anchors = 4
default_role = "code"
autodoc_member_order = "groupwise"
add_module_names = False
highlight_language = "text"
html_theme = "furo"
html_theme_options = {"light_css_variables": {"code-font-size": "75%"}}  # commands of 110 characters fit
suppress_warnings = ["misc.highlighting_failure"]  # the YAML of OpenCV begins with a line that is no YAML
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False


def navigation(folder):
    """Hidden tables of contents: a page belongs to the first heading of docs/README.md that links to it."""
    seen = {"README", "docs/README"}
    captions = {"Overview": ["docs/README"]}
    for section in (Path(folder) / "docs/README.md").read_text().split("\n## ")[1:]:
        caption = section.split("\n")[0]
        links = [re.sub(r"^docs/(\.\./|(?=notebooks/))", "", "docs/" + link)
                 for link in re.findall(r"\]\(([\w./-]+)\.(?:md|ipynb)[)#]", section)]
        captions[caption] = [page for page in dict.fromkeys(links) if page not in seen]
        seen |= set(links)
    captions["Reference"] = ["reference/python", "reference/cpp"]
    return "".join(f"\n```{{toctree}}\n:hidden:\n:caption: '{caption}'\n\n" + "\n".join("/" + page for page in pages) + "\n```\n"
                   for caption, pages in captions.items() if pages)


def add_navigation(app, page, source):
    if page == root_doc:
        app.env.note_dependency("docs/README.md")
        source[0] += navigation(app.srcdir)


def list_arguments(app, what, name, thing, options, lines):
    """In the docstrings of the module, `name: meaning` begins the text of an argument, which the next lines go on with."""
    inside = False
    for number, line in enumerate(lines):
        if re.match(r"[a-z_][\w, ]*: ", line):
            lines[number] = f":param {line}" if inside else f"\n:param {line}"
            inside = True
        elif inside and line and not line.startswith("Raises"):
            lines[number] = "   " + line
        elif inside:
            lines[number] = "\n" + line
            inside = False
    lines[:] = "\n".join(lines).split("\n")


def setup(app):
    app.add_lexer("csv", TextLexer)
    app.connect("source-read", add_navigation)
    app.connect("autodoc-process-docstring", list_arguments)
