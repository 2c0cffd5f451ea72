#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the English of comments, messages and pages in lines added since the rules began (CONTRIBUTING.md).

Usage: scripts/prose_lint.py [--base COMMIT] [--all] [PATH...]

Each pattern has no good use in this project. Its row contains the reason and the alternative. The list is short on purpose,
because a reader decides, not a count. With --all, checks the whole tree.
"""
from __future__ import annotations

import argparse
import pathlib
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from typing import NamedTuple

# The last commit before these rules.
START = "f1c70247b077e697e1d377e31d068388a3039c41"


class Rule(NamedTuple):
    pattern: str
    reason: str
    instead: str


RULES = [
    Rule(r"^(?:Who|Whether|Nobody|Nothing|Likewise)\b(?![^.]*\?)", "a fragment without a subject", "'Returns', 'True if', 'Null if', 'No effect if'"),
    Rule(r"^(?:What|That|Where) (?:[a-z]+ ){1,6}[a-z]+\.$", "a relative clause in place of a sentence", "a verb in the third person: 'Returns the ...'"),
    Rule(r"\bnobody\b", "software is not a person", "'no instance', 'no caller'"),
    Rule(r"\b(?:is|are|was|were|be|been) told\b|\btells? (?:it|them|the|a|an|of|who|what|whether)\b", "software does not talk", "'reports', 'logs', 'prints'"),
    Rule(r"\b(?:is|are|was|were) asked\b", "software is not asked", "'is queried', 'is requested'"),
    Rule(r"\b(?:goes|went) on\b|\bgo on (?:with|to|from|in)\b", "several meanings", "'continues', 'resumes'"),
    Rule(r"\b(?:that|which) is none\b|\bnothing,? when\b|\bnull,? when\b", "the condition comes last", "'If there is no ..., returns null.'"),
    Rule(r"\bfor ever\b|\bnow and then\b|\bso many\b|\bas of now\b", "vague", "'without end', 'sometimes', the number"),
    Rule(r"\bof its own accord\b|\bfalls? short\b|\bthe way there\b|\bnot any more\b", "idiom", "'alone', 'is too small', 'the latency', 'no longer'"),
    Rule(r"\b(?:what|which) (?:came|comes|goes|went)\b", "no subject", "the noun itself"),
]

SOURCES = {".hpp", ".h", ".cpp", ".c", ".py", ".ts", ".mjs", ".cmake", ".sh"}
PAGES = {".md", ".rst"}
COMMENT = re.compile(r'^\s*(?://+<?|#(?!include|define|if|endif|pragma|!)|\*|""")\s?(.*)')
MESSAGE = re.compile(r'"((?:[^"\\]|\\.){12,})"')
# Exempts files that must quote the patterns, and files with texts by other authors.
EXEMPT = {"scripts/prose_lint.py", "CONTRIBUTING.md", "docs/blind-reading.md"}


class Line(NamedTuple):
    path: str
    number: int
    text: str


def git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], capture_output=True, text=True, check=True, errors="replace").stdout


def added_lines(base: str, paths: list[str]) -> Iterator[Line]:
    """Yields the lines of the working tree that ``base`` lacks. The lines of a moved file are not added lines."""
    path, number = "", 0
    for line in git("diff", "--find-renames=40%", "--unified=0", base, "--", *paths).split("\n"):
        if line.startswith("+++ "):
            path = line[6:]
        elif line.startswith("@@"):
            number = int(re.search(r"\+(\d+)", line).group(1)) - 1
        elif line.startswith("+"):
            number += 1
            yield Line(path, number, line[1:])


def all_lines(paths: list[str]) -> Iterator[Line]:
    for name in filter(None, git("ls-files", "--", *paths).split("\n")):
        if pathlib.Path(name).suffix in SOURCES | PAGES:
            for number, text in enumerate(pathlib.Path(name).read_text(errors="replace").splitlines(), 1):
                yield Line(name, number, text)


def prose(line: Line) -> str | None:
    """Returns the part of a line that is prose, or None."""
    suffix = pathlib.Path(line.path).suffix
    if suffix in PAGES:
        return None if line.text.startswith(("```", "    ")) else line.text.strip(" |#-*")
    if suffix not in SOURCES:
        return None
    comment = COMMENT.match(line.text)
    if comment:
        return comment.group(1)
    return " ".join(text for text in MESSAGE.findall(line.text) if " " in text.strip()) or None


def findings(lines: Iterable[Line]) -> Iterator[tuple[Line, Rule, str]]:
    for line in lines:
        text = None if line.path in EXEMPT else prose(line)
        for rule in RULES if text else []:
            found = re.search(rule.pattern, text)
            if found:
                yield line, rule, found.group(0)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("paths", nargs="*", default=["."])
    parser.add_argument("--base", default=START, help="check the lines added since this commit")
    parser.add_argument("--all", action="store_true", help="check the whole tree")
    options = parser.parse_args()
    if not options.all and subprocess.run(["git", "cat-file", "-e", options.base], capture_output=True).returncode:
        print(f"prose_lint.py: skipped, because this clone does not contain commit {options.base[:8]} (a shallow clone?)")
        return 0
    count = 0
    for line, rule, text in findings(all_lines(options.paths) if options.all else added_lines(options.base, options.paths)):
        count += 1
        print(f"{line.path}:{line.number}: '{text}': {rule.reason}; write {rule.instead}")
    print(f"prose_lint.py: {count} findings" if count else "prose_lint.py: no findings")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
