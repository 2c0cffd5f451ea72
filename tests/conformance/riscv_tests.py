# SPDX-License-Identifier: Apache-2.0
"""Runs riscv-tests in the environment "p" (one hart, machine mode). These small programs test the instruction set and check
themselves.
"""

import re

from tools import BARE, WAYS, CannotRun, Verdict, build, checkout, run, soc_run

ADDRESS = "https://github.com/riscv-software-src/riscv-tests"
ENVIRONMENT = "https://github.com/riscv/riscv-test-env"
SUITES = {  # the core of each
    "rv32ui": "rv32imc", "rv32um": "rv32imc", "rv32uc": "rv32imc", "rv32mi": "rv32imcu", "rv32ua": "rv32imac", "rv32uf": "rv32imfc",
    "rv32uzba": "rv32imc_zba", "rv32uzbb": "rv32imc_zbb", "rv32uzbc": "rv32imc_zbc", "rv32uzbs": "rv32imc_zbs",
}
LIMIT = 10_000_000  # instructions; the longest needs some ten thousand


def environment(folder):
    """Returns the test environment: that of a recursive clone, or a separate checkout next to the clone."""
    for path in (folder / "riscv-tests/env", folder / "riscv-test-env"):
        if (path / "p/riscv_test.h").exists():
            return path
    raise CannotRun(f"{folder}/riscv-tests/env is empty: git clone --recursive, or git clone {ENVIRONMENT} {folder}/riscv-test-env")


def names(suite_folder):
    """Returns the tests that a suite's Makefrag lists."""
    text = (suite_folder / "Makefrag").read_text().replace("\\\n", " ")
    return re.search(rf"{suite_folder.name}_sc_tests\s*=\s*(.*)", text)[1].split()


def flags(isa, suite):
    """Returns -march and -mabi of the suites' Makefile."""
    text = (isa / "Makefile").read_text()
    return re.search(rf"compile_template,{suite},([^)]*)\)", text)[1].split()


def judge(folder, soc, work, each):
    """Returns the verdicts of all tests. `each(function, tests)` must return a list with the function's result for each test."""
    top = checkout(folder, "riscv-tests", ADDRESS)
    isa, env = top / "isa", environment(folder)
    tests = [(suite, name) for suite in SUITES for name in names(isa / suite)]

    def verdict(test):
        suite, name = test
        program = work / f"{suite}-{name}.elf"
        wrong = build([*BARE, *flags(isa, suite), f"-I{env}/p", f"-I{isa}/macros/scalar", f"-T{env}/p/link.ld",
                       isa / suite / f"{name}.S", "-o", program])
        for way in WAYS if wrong is None else ():
            code, text = run([*soc_run(soc, SUITES[suite]), *way, "--max-instructions", LIMIT, program])
            if code != 0 and wrong is None:
                wrong = f"case {code} fails" if code is not None and code < 101 else text.strip().splitlines()[-1]
        return Verdict(f"{suite} {name}", wrong is None, wrong or "")

    return each(verdict, tests)
