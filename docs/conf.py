"""Settings of Sphinx; ``make docs`` builds ``docs/_build/html``. Nothing here needs the network."""

from __future__ import annotations

import os
import shutil
from importlib.metadata import version as version_of

from sphinx.util.nodes import make_refnode

project = "pymoo_gridpath"
author = "The pymoo_gridpath developers"
project_copyright = "The pymoo_gridpath developers"
release = version = version_of("pymoo_gridpath")

extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
]
# What other pages include is no page.
exclude_patterns = ["_build", "jupyter_execute", "README.md", "peers_measured.md"]
templates_path = ["_templates"]
suppress_warnings: list[str] = []

# -- pages: Markdown with code that runs at every build --------------------------------------------------------------------

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
nb_execution_mode = "auto"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
# Cells may write files.
nb_execution_in_temp = True
nb_merge_streams = True
# That kernels are compiled, which depends on what was built before.
nb_output_stderr = "remove"
nb_render_markdown_format = "myst"

# -- reference, from the docstrings ----------------------------------------------------------------------------------------

autosummary_generate = True
autosummary_imported_members = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False
# A word in single backticks is a link if it names something of this package, and code otherwise.
default_role = "py:obj"

# -- look ------------------------------------------------------------------------------------------------------------------

html_theme = "pydata_sphinx_theme"
html_title = "pymoo_gridpath"
html_static_path = ["_static"]
html_css_files = ["custom.css"]
html_show_sourcelink = False
html_copy_source = False
PLAIN_PAGES = (
    "index",
    "tutorial",
    "robot",
    "own_cost",
    "method",
    "algorithms",
    "exact",
    "companions",
    "planners",
    "papers",
    "suites",
    "peers",
    "maps",
    "explorer",
    "command_line",
    "extend",
    "internals",
)
html_sidebars = {page: [] for page in PLAIN_PAGES}
html_theme_options = {
    "logo": {"text": "pymoo_gridpath"},
    "show_toc_level": 2,
    "header_links_before_dropdown": 6,
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
}

# -- links ----------------------------------------------------------------------------------------------------------------


def find_by_last_name(app, env, node, contnode):
    """Resolve a short name such as ``TradeOffSet.knee`` wherever in the package it is defined, if it is so once."""
    target = node.get("reftarget", "")
    if node.get("refdomain") != "py" or not target:
        return None
    objects = env.get_domain("py").objects
    found = {(entry.docname, entry.node_id) for name, entry in objects.items() if name.endswith(f".{target}")}
    if len(found) != 1:
        return None
    docname, anchor = found.pop()
    return make_refnode(app.builder, node["refdoc"], docname, anchor, contnode, target)


def clear_stubs(app, config):
    """Remove the stubs of an earlier build; one of a class that has since gone would be a page that no page leads to."""
    shutil.rmtree(app.srcdir / "api" / "generated", ignore_errors=True)


def set_up_kernels(app, config):
    """Give the kernels settings of their own: no start-up files of the user, and no remarks about their transport."""
    profile = app.doctreedir / "ipython" / "profile_default"
    profile.mkdir(parents=True, exist_ok=True)
    (profile / "ipython_kernel_config.py").write_text('c.IPKernelApp.log_level = "ERROR"\n')
    os.environ["IPYTHONDIR"] = str(profile.parent)
    # Pages run in folders of their own.
    os.environ["DOCS_FOLDER"] = str(app.srcdir)


def setup(app):
    app.connect("config-inited", clear_stubs)
    app.connect("config-inited", set_up_kernels)
    app.connect("missing-reference", find_by_last_name)
