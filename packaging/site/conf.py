"""Configuration of Sphinx for the site; scripts/dev/make-site runs it.

MyST reads Markdown as CommonMark, with tables, dollars for formulas and anchors of headings as on GitHub, so that the
pages of doc/ stay as they are. The extension module is imported for its docstrings.
"""

import pathlib
import re

project = "eses-blocks"
author = "the authors of eses-blocks"
_cmake = (pathlib.Path(__file__).parents[2] / "CMakeLists.txt").read_text(encoding="utf-8")
version = release = re.search(r"project\(eses-blocks VERSION ([\d.]+)", _cmake)[1]
root_doc = "README"
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
