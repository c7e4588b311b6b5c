"""Configuration of Sphinx for the site; scripts/dev/make-site runs it in the folder of the project.

MyST reads Markdown as CommonMark, with tables, dollars for formulas and anchors of headings as on GitHub, so that the
pages of doc/ stay as they are. The extension module is imported for its docstrings.
"""

import pathlib
import re

_project = pathlib.Path(__file__).parents[2]

project = "eses-blocks"
author = "the authors of eses-blocks"
_cmake = (_project / "CMakeLists.txt").read_text(encoding="utf-8")
version = release = re.search(r"project\(eses-blocks VERSION ([\d.]+)", _cmake)[1]
root_doc = "README"
include_patterns = ["*.md", "data/*.md", "doc/*.md", "packaging/site/*.md", "scripts/**/*.md", "src/*/*.md"]
suppress_warnings = ["toc.not_included"]  # the READMEs of folders
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx.ext.napoleon"]
myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = ["math"]  # formulas as GitHub has them
myst_heading_anchors = 6
autodoc_member_order = "groupwise"
autodoc_typehints = "description"
napoleon_google_docstring = False
napoleon_use_rtype = False
html_theme = "furo"
html_title = f"eses-blocks {version}"
html_show_sphinx = False
html_copy_source = False


def add_contents(_, name, source):
    """Adds the contents to the first page: the headings and pages of doc/README.md, each page once."""
    if name != root_doc:
        return
    parts = re.split(r"^## ", (_project / "doc/README.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    sections = {"": ["doc/README"]}
    for part in parts[1:]:
        pages = re.findall(r"^\| \[[^]]*\]\(([^)#]+)\.md\)", part, re.MULTILINE)
        sections[part.partition("\n")[0]] = [f"doc/{page}".replace("doc/../", "") for page in pages]
    sections["Reference"] = ["packaging/site/python", "packaging/site/cpp"]
    seen = set()
    for title, pages in sections.items():
        caption = f":caption: {title}\n" if title else ""
        new = [page for page in pages if page not in seen]
        seen.update(new)
        source[0] += f"\n```{{toctree}}\n:hidden:\n{caption}\n" + "".join(f"/{page}\n" for page in new) + "```\n"


def setup(app):
    app.connect("source-read", add_contents)
