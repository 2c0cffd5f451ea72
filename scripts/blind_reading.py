#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws comments, messages, help texts and pages for a blind reading of the project's English (docs/blind-reading.md).

Usage: scripts/blind_reading.py [--seed N] [--commit COMMIT] [--texts]

Prints 40 comments, 20 messages, 10 help texts and the names of 5 pages. Equal seed and commit give equal texts. A reader lists
every sentence that was not clear at the first reading. With --texts the pages are printed too. The headings contain the number of
sentences: texts of at least three words between full stops. A heading or a cell of a table counts as a text, also if it is a
fragment. Code, comments of HTML and targets of links do not count.
"""
from __future__ import annotations

import argparse
import ast
import pathlib
import random
import re
import sys
from collections.abc import Iterator
from typing import NamedTuple

import list_messages
import prose_lint

COUNTS = {"comments": 40, "messages": 20, "help texts": 10, "pages": 5}
MESSAGES = {"error", "warning", "log", "output", "text"}
HELP = {"help", "variable", "schema"}
# Lists of changes and generated reports are not pages to read at once.
NOT_PAGES = {"CHANGELOG.md", "examples/paper/REPORT.md", "docs/blind-reading.md"}
# Licences and instructions to tools are not read as prose.
NO_PROSE = re.compile(r"SPDX|clang-format o|NOLINT")
# In these languages a line that starts with # is for the preprocessor, or a private member.
NO_HASH_COMMENTS = {".hpp", ".h", ".cpp", ".c", ".ts", ".mjs"}
BLOCK = re.compile(r"^[ \t]*/\*+(.*?)\*/", re.MULTILINE | re.DOTALL)


class Draw(NamedTuple):
    place: str
    text: str


def docstrings(source: str) -> Iterator[tuple[int, str]]:
    """Yields the line and the text of every docstring of a Python file."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and (text := ast.get_docstring(node)):
            yield node.body[0].lineno, text


def line_comments(source: str, suffix: str) -> Iterator[tuple[int, str]]:
    """Yields comments of whole lines; consecutive lines are one comment."""
    no_comment = re.compile(r"\s*[*#]" if suffix in NO_HASH_COMMENTS else r'\s*(?:\*|""")')
    block: list[str] = []
    for number, line in enumerate(source.split("\n") + [""], 1):
        found = prose_lint.COMMENT.match(line)
        if found and not no_comment.match(line) and not NO_PROSE.search(line):
            block.append(found[1])
        elif block:
            yield number - len(block), " ".join(block)
            block = []


def block_comments(source: str) -> Iterator[tuple[int, str]]:
    for found in BLOCK.finditer(source):
        if not NO_PROSE.search(found[1]):
            yield source.count("\n", 0, found.start()) + 1, re.sub(r"^\s*\*\s?", "", found[1], flags=re.MULTILINE)


def comments(commit: str | None) -> Iterator[Draw]:
    """Yields comments of whole lines and docstrings, each up to its end."""
    for path in list_messages.names(commit, ["."]):
        suffix = pathlib.Path(path).suffix
        if suffix not in prose_lint.SOURCES:
            continue
        source = list_messages.read(path, commit)
        longer = docstrings(source) if path.endswith(".py") else block_comments(source)
        for line, text in sorted([*line_comments(source, suffix), *longer]):
            if len(text.split()) >= 4:
                yield Draw(f"{path}:{line}", list_messages.one_line(text))


def drawn(seed: int, commit: str | None) -> dict[str, list[Draw]]:
    texts = [(text.kind, Draw(f"{text.path}:{text.line}", list_messages.one_line(text.text))) for text in list_messages.texts(commit)]
    all_of = {
        "comments": list(comments(commit)),
        "messages": [draw for kind, draw in texts if kind in MESSAGES],
        "help texts": [draw for kind, draw in texts if kind in HELP],
        "pages": [Draw(path, "") for path in list_messages.names(commit, ["."]) if path.endswith(".md") and path not in NOT_PAGES],
    }
    return {kind: random.Random(f"{seed} {kind}").sample(draws, COUNTS[kind]) for kind, draws in all_of.items()}


def sentences(text: str) -> int:
    """Returns the number of sentences in a text, or in a page without its code, comments and targets of links."""
    prose = re.sub(r"^(```|~~~).*?^\1\s*$|^    .*?$|<!--.*?-->|(?<=\])\([^)\s]*\)", "", text, flags=re.MULTILINE | re.DOTALL)
    parts = re.split(r"\n\s*\n|\n(?=[-#|])|\||(?<=[.!?])\s", prose)
    return sum(len(re.findall(r"[A-Za-z]{2,}", part)) >= 3 for part in parts)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=46)
    parser.add_argument("--commit", help="draw from the files of this commit in place of the working tree")
    parser.add_argument("--texts", action="store_true", help="print the pages, too")
    options = parser.parse_args()
    for kind, draws in drawn(options.seed, options.commit).items():
        count = sum(sentences(list_messages.read(draw.place, options.commit) if kind == "pages" else draw.text) for draw in draws)
        print(f"## {len(draws)} {kind}, {count} sentences")
        for number, draw in enumerate(draws, 1):
            print(f"{number}. {draw.place}: {draw.text}".rstrip(": "))
            if kind == "pages" and options.texts:
                print(list_messages.read(draw.place, options.commit))
    return 0


if __name__ == "__main__":
    sys.exit(main())
