"""Settings of Sphinx; ``make docs`` builds ``docs/_build/html``. Nothing here needs the network."""

from __future__ import annotations

import os
import shutil
import sys
from importlib.metadata import version as version_of
from pathlib import Path

from sphinx.errors import ExtensionError
from sphinx.util import logging
from sphinx.util.nodes import make_refnode

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import finish

project = "pymoo_gridpath"
author = "The pymoo_gridpath developers"
project_copyright = "The pymoo_gridpath developers"
release = version = version_of("pymoo_gridpath")

extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.extlinks",
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
# Of a cell in seconds: of an endless one, not of one that compiles kernels on a busy machine.
nb_execution_timeout = 1200
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
# Only the reference has enough pages for a list of them on the left, which takes a quarter of the width.
_SOURCE = Path(__file__).resolve().parent
_FILES = [*_SOURCE.glob("*.md"), *_SOURCE.glob("studies/*.md")]
_PAGES = [file.relative_to(_SOURCE).with_suffix("").as_posix() for file in _FILES]
html_sidebars = {page: [] for page in _PAGES if page != "reference"}
html_theme_options = {
    "logo": {"text": "pymoo_gridpath"},
    "show_toc_level": 2,
    "header_links_before_dropdown": 4,
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
}

# pymoo's own pages: {pymoo}`NSGA-II <algorithms/moo/nsga2.html>`. Addresses, not an inventory, which would need the network.
extlinks = {"pymoo": ("https://pymoo.org/%s", "%s")}

# -- links ----------------------------------------------------------------------------------------------------------------


def find_by_last_name(app, env, node, contnode):
    """Resolve a short name such as ``TradeOffSet.knee`` wherever in the package it is defined, if it is so once."""
    target = node.get("reftarget", "")
    if node.get("refdomain") != "py" or not target:
        return None
    objects = env.get_domain("py").objects
    named = [entry for name, entry in objects.items() if name.endswith(f".{target}")]
    # A function goes before methods of its name.
    named = [entry for entry in named if entry.objtype not in ("method", "attribute", "property")] or named
    found = {(entry.docname, entry.node_id) for entry in named}
    if len(found) != 1:
        # In a docstring it may be code; on a page it was meant as a link.
        if Path(env.doc2path(node["refdoc"])).suffix == ".md" and "<autosummary>" not in str(node.source):
            what = "nothing" if not found else f"{len(found)} things"
            logging.getLogger(__name__).warning("%s is the name of %s", target, what, location=node)
        return None
    docname, anchor = found.pop()
    return make_refnode(app.builder, node["refdoc"], docname, anchor, contnode, target)


def finish_site(app, error):
    """Draw the thumbnails of the gallery and check what Sphinx does not: links as they stand in the pages, what is too much."""
    if error or app.builder.name != "html":
        return
    folder = Path(app.outdir).resolve()
    pages = finish.read_pages(folder)
    wrong = finish.draw_thumbnails(folder, pages) + finish.broken_links(folder, pages)
    wrong += finish.long_tutorials(folder, pages) + finish.wide_lines(folder, pages)
    if wrong:
        raise ExtensionError("\n".join(["the site is not as it should be:", *wrong]))


def deal_pages(app, env, docnames):
    """Mix pages whose code runs with the others, since processes of a parallel build take pages by the dozen."""
    docnames[:] = [name for first in range(_HANDS) for name in docnames[first::_HANDS]]


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


# Into so many parts, at most, a parallel build divides the pages.
_HANDS = 16


def setup(app):
    app.connect("config-inited", clear_stubs)
    app.connect("config-inited", set_up_kernels)
    app.connect("env-before-read-docs", deal_pages)
    app.connect("missing-reference", find_by_last_name)
    app.connect("build-finished", finish_site)
