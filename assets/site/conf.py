"""The site: README, assets/ and lessons/ read where they lie, and the docstrings of what Python users need.

``uv run --group docs sphinx-build -W -c assets/site . build/site`` builds it. The root of the repository is the source
folder, so that a link in a text leads to the same place on a code host and here; nothing is copied, and no page fetches
anything from elsewhere.
"""

import sys
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT), str(HERE)]

from app import __version__  # noqa: E402

project = "mpm-lab"
copyright = "the authors of mpm-lab, MIT licence"
version = release = __version__
html_title = f"mpm-lab {release}"
language = "en"

root_doc = "assets/site/index"
# A new text in these folders is a page, and one that no list of pages has is a warning, which is an error.
include_patterns = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "assets/**.md", "lessons/**.md"]
exclude_patterns = [".*", "app", "solvers", "tests", "build", "dist", "assets/paper", "lessons/scripts",
                    "lessons/*.de.md"]  # lessons in other languages are on the page, and in their files

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "docstrings", "lesson_pages",
              "formulas", "tables", "identity", "exported_bar"]
myst_enable_extensions = ["dollarmath", "colon_fence", "attrs_inline"]
myst_heading_anchors = 3  # as a code host has them, so that a link to a heading works on both
math_renderer = html_math_renderer = "latex2mathml"
nitpicky = False  # types of numpy and Taichi have no page here
highlight_language = "default"  # of indented blocks: coloured where they are Python, else as they stand

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_use_param = napoleon_use_rtype = False
python_maximum_signature_line_length = 100

html_theme = "furo"
html_static_path = ["style"]
html_css_files = ["site.css"]
html_extra_path = ["front"]  # the address of the site itself leads to its first page
html_favicon = "../../app/page/web/mark.svg"
html_logo = html_favicon
html_copy_source = html_show_sphinx = False
html_theme_options = {"sidebar_hide_name": False, "navigation_with_keys": True}
