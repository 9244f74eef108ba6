# GPL-2.0-or-later. Sphinx settings of the HTML manual; tools/scripts/manual builds it.
#
# The sources are the Markdown pages of the repository as they are, so that they also read well on GitHub. What Sphinx
# needs besides, the tables of contents, is added to the index here.
import os
import re

project = "q3map2-sh"
release = os.environ.get("MANUAL_VERSION", "")
copyright = "the q3map2-sh developers"  # noqa: A001 (a name that Sphinx asks for)
extensions = ["myst_parser"]
root_doc = "docs/README"
include_patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "docs/README.md",
                    "docs/recover_lights.md", "docs/reliability.md", "docs/guide/*.md", "docs/reference/*.md", "docs/engines/*.md",
                    "docs/internals/*.md", "tools/engines/README.md", "tools/engines/ioquake3/README.md",
                    "tools/viewer/README.md"]
myst_heading_anchors = 5
html_theme = "theme"
html_theme_path = ["."]
html_title = "q3map2-sh"
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
# A summary is fetched from each page, which browsers refuse for pages that are files.
html_show_search_summary = False
html_scaled_image_link = False
highlight_language = "none"
# Some snippets of C and shaders are not whole programs.
suppress_warnings = ["misc.highlighting_failure"]

# Parts of the manual in the order of the sidebar, with the pages that come first.
PARTS = {
    "Guide": ("guide", ["first_bake", "editors", "compiling", "lighting", "watch", "cache", "many_machines", "nightly",
                        "releasing", "relighting", "hdr_and_normal_maps", "static_props", "utilities", "viewer",
                        "gallery", "troubleshooting", "explain", "from_q3map2", "from_source_engine"]),
    "Reference": ("reference", ["command_line", "bsp", "vis", "light", "other_stages", "entity_keys",
                                "shader_directives", "glossary", "bsp_format", "json", "report", "game_files"]),
    "For engines": ("engines", ["quick_start", "tone", "textures", "named_lights", "grid_formats", "directional",
                                "props_and_hdr", "ioquake3", "conformance"]),
    "Internals": ("internals", ["architecture", "bsp", "vis", "lightmaps", "sh_grid", "sh_math", "scaling",
                                "differences", "results", "shbench", "windows", "arm64"]),
}
ABOUT = ["/README", "/docs/recover_lights", "/docs/reliability", "/SECURITY", "/CHANGELOG", "/CONTRIBUTING", "/tools/engines/README",
         "/tools/engines/ioquake3/README", "/tools/viewer/README"]


def contents():
    """Tables of contents in MyST, one for each part; the program shows them in the sidebar."""
    def table(caption, entries):
        return "\n```{toctree}\n:hidden:\n:caption: %s\n\n%s\n```\n" % (caption, "\n".join(entries))
    return "".join(table(caption, [f"{folder}/{name}" for name in names]) for caption, (folder, names) in
                   PARTS.items()) + table("The project", ABOUT)


# What the pages link to outside of the manual are files of the sources.
OUTSIDE = re.compile(r"\[([^\]]*)\]\((?!https?:|#)([^)#\s]*)(#[^)\s]*)?\)")


def is_page(target):
    return target.endswith((".md", ".png", ".jpg", ".svg", ".csv"))


def prepare(app, name, source):
    """Keeps links to pages, pictures and tables; of links to other files only the text."""
    def link(match):
        text, target, _ = match.groups()
        return match.group() if not target or is_page(target) and "libs/" not in target else text
    source[0] = OUTSIDE.sub(link, source[0])
    if name == root_doc:
        source[0] += contents()


def setup(app):
    app.connect("source-read", prepare)
    return {"parallel_read_safe": True}
