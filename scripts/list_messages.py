#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lists every text that users of MEbots can see.

Usage: scripts/list_messages.py [--commit COMMIT] [--kind KIND...] [PATH...] > messages.txt

Prints one text per line: kind, file:line, text. The kinds are error, warning, log, help, output, page, variable, schema and text.
Joins adjacent literals.
"""
from __future__ import annotations

import argparse
import json
import pathlib
import re
import subprocess
import sys
from collections.abc import Iterator
from typing import NamedTuple

import prose_lint

# Folders with texts for users. Tests, benchmarks and examples print only for developers.
PRODUCT = re.compile(r"^(?:master|modeldesc|fmu_\w+|web/src|configs/schemas)/")
SUFFIXES = {".cpp", ".hpp", ".c", ".h", ".py", ".ts"}
# Also matches comments and character literals, so that quotes in them do not start a literal.
CPP = re.compile(
    r"(?P<skip>//[^\n]*|/\*.*?\*/|(?<!\w)'(?:[^'\\\n]|\\.)+')"
    r'|R"(?P<fence>\w*)\((?P<raw>.*?)\)(?P=fence)"'
    r'|"(?P<plain>(?:[^"\\\n]|\\.)*)"',
    re.DOTALL,
)
SCRIPT = re.compile(
    r"(?P<skip>//[^\n]*|/\*.*?\*/|^\s*\#[^\n]*|\s\#\s[^\n]*|\"{3}.*?\"{3})"
    r'|"(?P<plain>(?:[^"\\\n]|\\.)*)"'
    r"|'(?P<single>(?:[^'\\\n]|\\.)*)'"
    r"|`(?P<raw>(?:[^`\\]|\\.)*)`",
    re.DOTALL | re.MULTILINE,
)
# Excludes the texts of assertions, which are for developers.
ASSERTION = re.compile(r"(?:MEBOTS_ASSERT|static_assert)\((?:[^;\"]|\"[^\"]*\"\s*,)*$")
KINDS = [
    ("error", r"throw|raise |Error\b|error\w*\(|refuse|fail|complain|mistake|finding|fault"),
    ("warning", r"warn|notice|note_|notify"),
    ("help", r"add_option|add_flag|add_subcommand|add_argument|footer|description\(|help="),
    ("log", r"log\w*\(|Severity|message\("),
    ("output", r"print|cout|cerr|stdout|stderr|write"),
]


class Text(NamedTuple):
    kind: str
    path: str
    line: int
    text: str


def read(path: str, commit: str | None) -> str:
    if commit is None:
        return pathlib.Path(path).read_text(errors="replace")
    return prose_lint.git("show", f"{commit}:{path}")


def names(commit: str | None, paths: list[str]) -> list[str]:
    listed = prose_lint.git("ls-files", "--", *paths) if commit is None else prose_lint.git("ls-tree", "-r", "--name-only", commit, "--", *paths)
    return sorted(filter(None, listed.split("\n")))


def is_prose(text: str) -> bool:
    """True if the text is prose: it has at least two words of letters, and is no path, pattern or code."""
    return len(re.findall(r"(?:^|\s)\(?[A-Za-z']{2,}[,.:;)]?(?=\s|$)", text)) >= 2 and not re.search(r"\{\{|;\s*(?:\n|$)|\bvoid\b|#include|=>|&&", text)


def kind_of(path: str, before: str) -> str:
    if path.endswith(".ts"):
        return "page"
    return next((kind for kind, pattern in KINDS if re.search(pattern, before)), "text")


def literals(path: str, source: str) -> Iterator[Text]:
    """Yields the texts of a source file. Adjacent literals are joined."""
    joined, start, end = "", 0, -1
    pattern = SCRIPT if path.endswith((".py", ".ts")) else CPP
    for found in [*pattern.finditer(source), None]:
        groups = found.groupdict() if found else {}
        if groups.get("skip") is not None:
            continue
        value = next((groups[name] for name in ("raw", "plain", "single") if groups.get(name) is not None), "")
        if end < 0 or found is None or re.sub(r"\s|[rbf](?=$)", "", source[end : found.start()]):
            if is_prose(joined) and not ASSERTION.search(source[max(0, start - 300) : start]):
                before = re.split(r"[;{}]\s*\n", source[max(0, start - 600) : start])[-1]
                yield Text(kind_of(path, before), path, source.count("\n", 0, start) + 1, joined)
            joined, start = "", found.start() if found else 0
        joined += value
        end = found.end() if found else -1


def described(path: str, source: str) -> Iterator[Text]:
    """Yields the descriptions in a JSON file: those of an FMU's variables, or of a schema's keys."""
    kind, keys = ("schema", "description|title") if "schemas/" in path else ("variable", "description|text")
    for found in re.finditer(rf'"(?:{keys})":\s*("(?:[^"\\]|\\.)*")', source):
        yield Text(kind, path, source.count("\n", 0, found.start()) + 1, json.loads(found[1]))


def texts(commit: str | None = None, paths: list[str] | None = None) -> Iterator[Text]:
    for path in names(commit, paths or ["."]):
        if not PRODUCT.match(path) or re.search(r"/(?:docs|templates|node_modules|firmware)/|_pb2", path):
            continue
        if path.endswith("description.json") or path.endswith(".schema.json"):
            yield from described(path, read(path, commit))
        elif pathlib.Path(path).suffix in SUFFIXES:
            yield from literals(path, read(path, commit))


def one_line(text: str) -> str:
    return re.sub(r"\s+", " ", text.replace("\\n", " ").replace('\\"', '"')).strip()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("paths", nargs="*", default=["."])
    parser.add_argument("--commit", help="read the files of this commit in place of the working tree")
    parser.add_argument("--kind", nargs="+", help="list only texts of these kinds")
    options = parser.parse_args()
    for text in texts(options.commit, options.paths):
        if not options.kind or text.kind in options.kind:
            print(f"{text.kind:8} {text.path}:{text.line}: {one_line(text.text)}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except BrokenPipeError:
        sys.exit(0)
