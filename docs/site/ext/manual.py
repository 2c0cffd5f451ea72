# SPDX-License-Identifier: Apache-2.0
"""```{manual} mebots```: inserts the manual of a program and those of its commands. The program generates them from its parser
(cmake/MebotsManual.cmake). This module reads the subset of man(7) that modeldesc/command_line/manual.cpp writes."""

import os
import re
from pathlib import Path

from sphinx.util.docutils import SphinxDirective


def plain(text):
    return re.sub(r"\\f[BIR]", "", text).replace("\\-", "-").replace("\\&", "").replace("\\e", "\\")


def code(text):
    return f"`{plain(text)}`"


def markdown(manual, level):
    """Returns the manual as MyST, with its sections below a heading of this level."""
    lines, result, words = iter(manual.splitlines()), [], []
    for line in lines:
        if line.startswith(".SH "):
            title = line[4:]
            if title not in ("NAME", "SYNOPSIS"):
                result += ["", f"**{title.capitalize()}**", ""]
            words = [] if title == "SYNOPSIS" else None
            if title == "NAME":
                name, text = plain(next(lines)).split(" - ", 1)
                result += [f"{'#' * level} {name}", "", text + ".", ""]
        elif words is not None and line != ".TP" and not line.startswith(".TH"):
            words.append(plain(line.removeprefix(".B ")))
            if result and result[-1].startswith("    "):
                result.pop()
            result.append("    " + " ".join(words))
        elif line == ".TP":
            result += [code(next(lines)), ": " + plain(next(lines)).replace("<", "\\<"), ""]
        elif line == ".nf":
            result += ["", "```none"]
            for inner in lines:
                if inner == ".fi":
                    break
                result.append(plain(inner))
            result += ["```", ""]
        elif line == ".PP" or line.startswith(".TH"):
            result.append("")
        else:
            result.append(plain(line).replace("<", "\\<"))
    return "\n".join(result)


class Manual(SphinxDirective):
    required_arguments = 1
    has_content = False

    def run(self):
        program = self.arguments[0]
        folder = Path(os.environ["MEBOTS_DOCS_BUILD"]) / "manual/man1"
        pages = [folder / f"{program}.1"]
        for command in re.findall(r"\\fB(.+?)\\fR\(1\)", pages[0].read_text()):
            pages.append(folder / f"{plain(command)}.1")
        parts = []
        for page in pages:
            self.env.note_dependency(str(page))
            manual = re.sub(r"\.SH SEE ALSO\n.*?(?=\.SH|\Z)", "", page.read_text(), flags=re.DOTALL)
            parts.append(markdown(manual, 2 if page == pages[0] else 3))
        return self.parse_text_to_nodes("\n\n".join(parts), allow_section_headings=True)


def setup(app):
    app.add_directive("manual", Manual)
    return {"parallel_read_safe": True}
