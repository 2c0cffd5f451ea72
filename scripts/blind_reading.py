#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws comments, messages, help texts and pages for a blind reading of the project's English (docs/blind-reading.md).

Usage: scripts/blind_reading.py [--seed N] [--commit COMMIT] [--texts] [--code [LINES]] [--tree PATH [PATHSPEC...]]

Prints 40 comments, 20 messages, 10 help texts and the names of 5 pages. Equal seed and commit give equal texts. A reader lists
every sentence that was not clear at the first reading. With --texts, also prints the pages. The headings contain the number of
sentences: texts of at least three words between full stops. A heading or a cell of a table counts as a text, also if it is a
fragment. Code, comments of HTML and targets of links do not count.

With --code, each comment is followed by the next lines of code (default: 3); a docstring is followed by its definition. With
--tree, only comments are drawn, from the git checkout of any project; git pathspecs exclude its third-party files.
"""
from __future__ import annotations

import argparse
import ast
import itertools
import os
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
# Excludes lists of changes and generated reports.
NOT_PAGES = {"CHANGELOG.md", "examples/paper/REPORT.md", "docs/blind-reading.md"}
# Excludes licences and instructions to tools.
NO_PROSE = re.compile(r"SPDX|Mozilla[\s*]+Public[\s*]+License|Copyright \(c\)|clang-format o|NOLINT")
# In these languages, a line that starts with # is a preprocessor directive or a private member.
NO_HASH_COMMENTS = {".hpp", ".h", ".cpp", ".c", ".ts", ".mjs"}
BLOCK = re.compile(r"^[ \t]*/\*+(.*?)\*/", re.MULTILINE | re.DOTALL)


class Draw(NamedTuple):
    place: str
    text: str
    code: list[str] = []


class Comment(NamedTuple):
    line: int
    code_line: int
    text: str


def docstrings(source: str) -> Iterator[Comment]:
    """Yields every docstring of a Python file. Its code is the definition; for a module, the code after the docstring."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and (text := ast.get_docstring(node)):
            literal = node.body[0]
            yield Comment(literal.lineno, literal.end_lineno + 1 if isinstance(node, ast.Module) else node.lineno, text)


def line_comments(source: str, suffix: str) -> Iterator[Comment]:
    """Yields comments of whole lines; consecutive lines are one comment."""
    no_comment = re.compile(r"\s*[*#]" if suffix in NO_HASH_COMMENTS else r'\s*(?:\*|""")')
    block: list[str] = []
    for number, line in enumerate(source.split("\n") + [""], 1):
        found = prose_lint.COMMENT.match(line)
        if found and not no_comment.match(line) and not NO_PROSE.search(line):
            block.append(found[1])
        elif block:
            yield Comment(number - len(block), number, " ".join(block))
            block = []


def block_comments(source: str) -> Iterator[Comment]:
    for found in BLOCK.finditer(source):
        if not NO_PROSE.search(found[1]):
            line, code_line = (source.count("\n", 0, place) + 1 for place in found.span())
            yield Comment(line, code_line + 1, re.sub(r"^\s*\*\s?", "", found[1], flags=re.MULTILINE))


def comments(commit: str | None, paths: list[str], code_lines: int) -> Iterator[Draw]:
    """Yields comments of whole lines and docstrings, each with the first ``code_lines`` lines of the code after it."""
    for path in list_messages.names(commit, paths):
        suffix = pathlib.Path(path).suffix
        if suffix not in prose_lint.SOURCES:
            continue
        source = list_messages.read(path, commit)
        lines = source.split("\n")
        longer = docstrings(source) if path.endswith(".py") else block_comments(source)
        for comment in sorted([*line_comments(source, suffix), *longer]):
            if len(comment.text.split()) >= 4:
                code = itertools.islice(filter(str.strip, lines[comment.code_line - 1 :]), code_lines)
                yield Draw(f"{path}:{comment.line}", list_messages.one_line(comment.text), list(code))


def drawn(options: argparse.Namespace) -> dict[str, list[Draw]]:
    all_of = {"comments": list(comments(options.commit, options.paths, options.code))}
    if not options.tree:
        commit = options.commit
        texts = [(text.kind, Draw(f"{text.path}:{text.line}", list_messages.one_line(text.text))) for text in list_messages.texts(commit)]
        all_of["messages"] = [draw for kind, draw in texts if kind in MESSAGES]
        all_of["help texts"] = [draw for kind, draw in texts if kind in HELP]
        all_of["pages"] = [Draw(path, "") for path in list_messages.names(commit, ["."]) if path.endswith(".md") and path not in NOT_PAGES]
    return {kind: random.Random(f"{options.seed} {kind}").sample(draws, COUNTS[kind]) for kind, draws in all_of.items()}


def sentences(text: str) -> int:
    """Returns the number of sentences in a text. Does not count code, comments and targets of links in a page."""
    prose = re.sub(r"^(```|~~~).*?^\1\s*$|^    .*?$|<!--.*?-->|(?<=\])\([^)\s]*\)", "", text, flags=re.MULTILINE | re.DOTALL)
    parts = re.split(r"\n\s*\n|\n(?=[-#|])|\||(?<=[.!?])\s", prose)
    return sum(len(re.findall(r"[A-Za-z]{2,}", part)) >= 3 for part in parts)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=46)
    parser.add_argument("--commit", help="draw from the files of this commit in place of the working tree")
    parser.add_argument("--texts", action="store_true", help="print the pages, too")
    parser.add_argument("--code", type=int, nargs="?", const=3, default=0, metavar="LINES", help="print the code that follows each comment")
    parser.add_argument("--tree", type=pathlib.Path, help="draw only comments, from this git checkout of any project")
    parser.add_argument("paths", nargs="*", default=["."], metavar="PATHSPEC", help="limits the comments to these files")
    options = parser.parse_args()
    if options.tree:
        os.chdir(options.tree)
    for kind, draws in drawn(options).items():
        count = sum(sentences(list_messages.read(draw.place, options.commit) if kind == "pages" else draw.text) for draw in draws)
        print(f"## {len(draws)} {kind}, {count} sentences")
        for number, draw in enumerate(draws, 1):
            print(f"{number}. {draw.place}: {draw.text}".rstrip(": "))
            print("".join(f"        {line}\n" for line in draw.code), end="")
            if kind == "pages" and options.texts:
                print(list_messages.read(draw.place, options.commit))
    return 0


if __name__ == "__main__":
    sys.exit(main())
