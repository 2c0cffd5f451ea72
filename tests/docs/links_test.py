# SPDX-License-Identifier: Apache-2.0
"""Checks that every link between pages of the documentation leads to a file and, if the link contains a heading, to this heading.
Does not need Sphinx."""

import re
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
AWAY = {"build", ".venv", "node_modules", ".git", "results", "templates"}
LINK = re.compile(r"\]\(([^()\s]+)\)")
CODE = re.compile(r"^(```|~~~).*?^\1\s*$|`[^`\n]*`", re.MULTILINE | re.DOTALL)


def slug(heading):
    """Returns the anchor that GitHub and MyST make from a heading."""
    words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.strip()).lower()
    return re.sub(r"[^\w\- ]", "", words).replace(" ", "-")


def anchors(page):
    text = re.sub(r"^(```|~~~).*?^\1\s*$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    return {slug(heading) for heading in re.findall(r"^#{1,6} (.+)$", text, re.MULTILINE)}


def broken_links(page):
    for target in LINK.findall(CODE.sub("", page.read_text(encoding="utf-8"))):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        place = (page.parent / path).resolve() if path else page
        if not place.exists():
            yield f"{page}: {target}: there is no such file"
        elif anchor and place.suffix == ".md" and anchor not in anchors(place):
            yield f"{page}: {target}: there is no such heading"


class Links(unittest.TestCase):
    def test_every_link_between_pages_leads_somewhere(self):
        pages = [page for page in ROOT.rglob("*.md") if not AWAY.intersection(page.relative_to(ROOT).parts)]
        self.assertGreater(len(pages), 40)
        self.assertEqual([], [link for page in pages for link in broken_links(page)])

    def test_finds_broken_links_and_ignores_code(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            page.write_text("# Is `a` here?\n[good](#is-a-here) [bad](#there) [gone](gone.md) `[code](gone.md)`\n")
            self.assertEqual(["#there", "gone.md"], [link.split(": ")[1] for link in broken_links(page)])


if __name__ == "__main__":
    sys.exit(unittest.main())
