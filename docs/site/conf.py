# SPDX-License-Identifier: Apache-2.0
"""Configuration of the site. The repository's root is the source folder, so that READMEs are pages without being copied.
scripts/docs.sh calls Sphinx with this folder as configuration."""

import os
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["MEBOTS_DOCS_BUILD"])
sys.path.insert(0, str(Path(__file__).parent / "ext"))
sys.path.insert(0, str(BUILD / "python"))

project = "MEbots"
author = "the MEbots authors"
copyright = "the MEbots authors, Apache-2.0"
release = version = re.search(r"project\(mebots VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]

extensions = ["myst_nb", "breathe", "sphinx.ext.autodoc", "sphinx_copybutton", "repository", "manual", "schema", "fmu_variables"]
root_doc = "docs/index"
include_patterns = [
    "*.md",
    "docs/**",
    "bench/README.md",
    "bench/**/*.md",
    "examples/README.md",
    "examples/**/*.md",
    "fmu_*/README.md",
    "fmu_*/**/*.md",
    "master/*.md",
    "modeldesc/*.md",
    "tests/**/*.md",
]
exclude_patterns = ["docs/site/**", "docs/img/**"]

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4
myst_url_schemes = ["http", "https", "mailto"]
highlight_language = "none"
copybutton_exclude = ".linenos, .gp, .go"

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

breathe_projects = {"mebots": str(Path(os.environ["MEBOTS_DOCS_XML"]))}
breathe_default_project = "mebots"
breathe_default_members = ("members",)

autodoc_member_order = "bysource"
autodoc_typehints = "signature"

nitpick_ignore_regex = [
    # Names of other projects. Their sites are not queried, because nothing is downloaded while the pages are built.
    ("py:.*", r"(os|collections|concurrent|np|npt|numpy|pathlib)\..*"),
    # Namespaces, which have no page.
    ("cpp:identifier", r"(std|(mebots::)?(fmu|soc|state)|mebots)"),
]

html_theme = "furo"
html_title = f"MEbots {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_extra_path = ["root"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
