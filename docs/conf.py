"""The site of the pages; scripts/api_docs runs Sphinx from the project's folder."""

import pathlib
import re

project = html_title = 'rgbd_pose'
extensions = ['myst_parser']
root_doc = 'README'
needs_sphinx = '5.1'  # for include_patterns
include_patterns = ['*.md', 'docs/**.md']
myst_heading_anchors = 3  # links to headings work as on GitHub
html_theme = 'sphinx_rtd_theme'
html_css_files = html_static_path = ['site.css']
html_copy_source = False
html_show_copyright = False
html_use_index = False
smartquotes = False


def add_navigation(app, page, source):
    """Lists the pages on the left in the order and groups of docs/README.md."""
    if page != root_doc:
        return
    text = pathlib.Path(app.srcdir, 'docs/README.md').read_text()
    intro, *groups = re.split(r'^\*\*(.*)\*\*$', text, flags=re.M)
    groups = ['Look up', '[Pages](README.md)' + intro, *groups]
    for caption, links in zip(groups[::2], groups[1::2]):
        pages = re.findall(r'\]\((\S+)\.md\)', links)
        source[0] += '\n'.join(
            ['\n```{toctree}', ':hidden:', f':caption: {caption}', '',
             *(f'docs/{name}' for name in pages), '```', ''])


def setup(app):
    app.connect('source-read', add_navigation)
