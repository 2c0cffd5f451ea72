# SPDX-License-Identifier: Apache-2.0
"""Links between files of the repository. A link to a folder leads to the page of its README; one to a folder without a page shows its
text. A broken link is a warning, which fails the build."""

import re
from pathlib import Path

from sphinx.util import logging

LINK = re.compile(r"(?<!!)\[([^\[\]]*(?:!\[[^\]]*\][^\[\]]*)?)\]\(([^()\s]+)\)")
FENCE = re.compile(r"^(```|~~~|:::).*?^\1`*\s*$", re.MULTILINE | re.DOTALL)
logger = logging.getLogger(__name__)


def resolve_links(app, docname, content):
    page = Path(app.env.doc2path(docname))
    if page.suffix != ".md":
        return
    root = Path(app.srcdir).resolve()

    def resolved(match):
        text, target = match[1], match[2]
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        path, _, anchor = target.partition("#")
        place = (page.parent / path).resolve()
        if not place.exists() or not place.is_relative_to(root):
            logger.warning("link to %s: there is no such file", target, location=docname)
            return text
        if place.is_dir():
            readme = place / "README.md"
            if readme.relative_to(root).as_posix() in pages:
                return f"[{text}]({path.rstrip('/')}/README.md{'#' + anchor if anchor else ''})"
            return text
        return match[0]

    pages = {Path(app.env.doc2path(name)).resolve().relative_to(root).as_posix() for name in app.env.found_docs}
    parts, begin = [], 0
    for fence in FENCE.finditer(content[0]):
        parts += [LINK.sub(resolved, content[0][begin : fence.start()]), fence[0]]
        begin = fence.end()
    content[0] = "".join(parts) + LINK.sub(resolved, content[0][begin:])


def setup(app):
    app.connect("source-read", resolve_links)
    return {"parallel_read_safe": True}
