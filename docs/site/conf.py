"""Sphinx's configuration of the site (scripts/site.sh). docs/dev/decisions/site.md gives the reasons."""

import re
from pathlib import Path

project = html_title = "Raymap"
extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
include_patterns = ["*.rst", "reference/**", "*.md", "docs/**", "examples/animated/README.md"]
exclude_patterns = ["docs/site"]
html_theme = "furo"
html_static_path = ["docs/site/static"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_show_copyright = html_show_sphinx = html_copy_source = False
myst_heading_anchors = 4
breathe_projects = {"raymap": "doxygen/xml"}
breathe_default_project = "raymap"
breathe_show_include = False
breathe_domain_by_file_pattern = {"*/c.h": "c"}
suppress_warnings = ["duplicate_declaration"]  # Headers open one namespace; C types are called as their structs.
autodoc_mock_imports = ["torch", "jax", "dask", "distributed"]
toc_object_entries = False  # They would take half of the build's time.
autodoc_member_order = "bysource"


def adapt_page(app, name, content):
    """Links to folders lead to their README. Records of decisions stand in the list of their folder alone."""
    page = Path(app.srcdir, name).parent

    def folder_link(link):
        text, target = link.groups()
        return f"[{text}]({target}README.md)" if (page / target / "README.md").exists() else text

    content[0] = re.sub(r"\[([^\]]*)\]\(([\w./]*/)\)", folder_link, content[0])
    if re.fullmatch(r"docs/dev/decisions/(?!README).*", name):
        content[0] = f"---\norphan: true\n---\n{content[0]}"


def adapt_docstring(app, what, name, obj, options, lines):
    """Keeps |x| a magnitude, which reStructuredText takes for the name of a text, and leaves out what Python makes up."""
    lines[:] = [line.replace("|", r"\|") for line in lines if not line.startswith("Alias for field number")]


def setup(app):
    app.connect("source-read", adapt_page)
    app.connect("autodoc-process-docstring", adapt_docstring)
