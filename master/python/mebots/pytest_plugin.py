# SPDX-License-Identifier: Apache-2.0
"""Collects test cases of FMUs for pytest. Each case in a file named ``*.mebots-test.json`` or ``CASES.json`` is a test.

The FMU is named in the file, or by the option ``--mebots-fmu``. See docs/testing-fmus.md. The fixture ``chip`` runs
programs on boards: mebots.testing.
"""

from __future__ import annotations

import contextlib
import json
import pathlib
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from mebots import _mebots
from mebots.errors import Error
from mebots.testing import Board


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("mebots")
    group.addoption("--mebots-fmu", metavar="FILE.fmu", help="FMU that the collected cases test, in place of the one they name")
    group.addoption("--mebots-isolate", action="store_true", help="run FMUs in processes of their own")


def pytest_collect_file(file_path: pathlib.Path, parent: pytest.Collector) -> CaseFile | None:
    if file_path.name == "CASES.json" or file_path.name.endswith(".mebots-test.json"):
        return CaseFile.from_parent(parent, path=file_path)
    return None


class CaseFile(pytest.File):
    def collect(self) -> Iterator[Case]:
        for name in _mebots.case_names(str(self.path)):
            yield Case.from_parent(self, name=name)


class Diverged(Exception):
    """Raised if a case did not pass. The text names the place of the case in its file."""


class Case(pytest.Item):
    def runtest(self) -> None:
        options = self.config.option
        result: dict[str, Any] = json.loads(
            _mebots.run_case(str(self.path), self.name, options.mebots_fmu, options.mebots_isolate)
        )
        if result["verdict"] != "passed":
            raise Diverged(result["text"])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException]) -> Any:  # type: ignore[override]
        if isinstance(excinfo.value, (Diverged, Error)):
            return f"{self.path.name}: {self.name}: {excinfo.value}"
        return super().repr_failure(excinfo)

    def reportinfo(self) -> tuple[pathlib.Path, int | None, str]:
        return self.path, None, f"case {self.name}"


@pytest.fixture
def chip() -> Iterator[Callable[..., Board]]:
    """Starts programs on boards, as ``chip("hello.elf", board="virt")``, and ends them after the test."""
    with contextlib.ExitStack() as boards:
        yield lambda program, **how: boards.enter_context(Board(program, **how))
