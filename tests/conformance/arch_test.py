# SPDX-License-Identifier: Apache-2.0
"""Runs riscv-arch-test, and compares the result words of its programs with those of Spike.

A test states the machines to which it applies, in lines such as:

    RVTEST_CASE(0,"//check ISA:=regex(.*32.*);check ISA:=regex(.*I.*C.*);def TEST_CASE_1=True;",cadd)

>>> holds("//check ISA:=regex(.*32.*);check ISA:=regex(.*I.*M.*);def TEST_CASE_1=True;", ISA)
['TEST_CASE_1=True']
>>> holds("//check ISA:=regex(.*32.*);check ISA:=regex(.*I.*F.*);def TEST_CASE_1=True;", ISA)
>>> holds("//check ISA:=regex(.*I.*); check hw_data_misaligned_support:=True; def rvtest_mtrap_routine=True;def TEST_CASE_1=True;", ISA)
['rvtest_mtrap_routine=True', 'TEST_CASE_1=True']
>>> holds("//check ISA:=regex(.*I.*Zicsr.*); check hw_data_misaligned_support:=False; def TEST_CASE_1=True;", ISA)
>>> holds("//check ISA:=regex(.*I.*Zicsr.*); check ISA:=regex(^[^C]+$); def TEST_CASE_1=True;", ISA)
"""

import re

from tools import BARE, ROOT, WAYS, Verdict, build, checkout, run, soc_run, spike

ADDRESS = "https://github.com/riscv-non-isa/riscv-arch-test"
ISA = "RV32IMCZicsr_Zifencei"
PROPERTIES = {"hw_data_misaligned_support": "True"}
SUITES = ("I", "M", "C", "Zifencei", "privilege", "A", "B", "F")
OPTIONS = {  # of the core: for the tests' conditions, for compiler, Spike and the chip's program
    "A": ("RV32IMACZicsr_Zifencei", "rv32imac"),
    "B": ("RV32IMCZicsr_Zifencei_Zba_Zbb_Zbc_Zbs", "rv32imc_zba_zbb_zbc_zbs"),
    "F": ("RV32IMFCZicsr_Zifencei", "rv32imfc"),
}
LOADS_UNALIGNED = "zicsr_zifencei_zicclsm"  # Spike also loads and stores unaligned words
LIMIT = 10_000_000
HERE = ROOT / "tests/conformance"


def holds(condition, isa):
    """Returns the macros of a test case. If the case does not apply to this machine, returns None."""
    macros = []
    for clause in filter(None, (part.strip() for part in condition.lstrip("/ ").split(";"))):
        kind, text = clause.split(maxsplit=1)
        if kind == "def":
            macros.append(text)
            continue
        key, wanted = text.split(":=")
        pattern = re.fullmatch(r"regex\((.*)\)", wanted)
        found = isa if key == "ISA" else PROPERTIES.get(key)
        if not (re.match(pattern[1], found) if pattern else found == wanted):
            return None
    return macros


def cases(source, isa=ISA):
    """Returns the macros of all cases of a test that apply to this machine."""
    conditions = re.findall(r'RVTEST_CASE\(\d+,\s*"([^"]*)"', source.read_text())
    return sorted({macro for condition in conditions for macro in holds(condition, isa) or ()})


def letters(source, isa, core):
    """Returns the letters of the ISA. Includes C only for tests of compressed instructions, because the assembler would otherwise
    compress instructions of other tests.
    """
    name, _, others = core.partition("_")
    base = name.replace("c", "") if cases(source, isa.replace("C", "")) == cases(source, isa) else name
    return "_".join(filter(None, (base, "zicsr_zifencei", others)))


def judge(folder, soc, work, each):
    """Returns the verdicts of all tests that apply to this machine."""
    suite = checkout(folder, "riscv-arch-test", ADDRESS) / "riscv-test-suite"
    reference = spike()
    tests = [(name, source) for name in SUITES for source in sorted((suite / "rv32i_m" / name / "src").glob("*.S"))
             if cases(source, OPTIONS.get(name, (ISA,))[0])]

    def verdict(test):
        name, source = test
        isa, core = OPTIONS.get(name, (ISA, "rv32imc"))
        stem = work / f"{name}-{source.stem}"
        program = stem.with_suffix(".elf")
        wrong = build([*BARE, f"-march={letters(source, isa, core)}", "-mabi=ilp32", "-DXLEN=32", *(["-DFLEN=32"] if name == "F" else []),
                       *(f"-D{macro}" for macro in cases(source, isa)), f"-I{HERE}", f"-I{suite}/env", f"-T{HERE}/link.ld", source, "-o", program])
        if wrong is None:
            wanted = stem.with_suffix(".spike")
            code, text = run([reference, f"--isa={core}_{LOADS_UNALIGNED}", "--priv=m", f"+signature={wanted}", "+signature-granularity=4", program])
            wrong = None if code == 0 else f"Spike ends with {code}: {text.strip()[-80:]}"
        for way in WAYS if wrong is None else ():
            ours = stem.with_suffix(".ours")
            code, text = run([*soc_run(soc, core), *way, "--max-instructions", LIMIT, "--signature", ours, program])
            if wrong is None:
                wrong = difference(wanted, ours) if code == 0 else f"ends with {code}: {text.strip()[-80:]}"
        return Verdict(f"{name} {source.stem}", wrong is None, wrong or "")

    return each(verdict, tests)


def difference(wanted, found):
    theirs, ours = wanted.read_text().split(), found.read_text().split()
    if len(theirs) != len(ours) or not theirs:
        return f"{len(ours)} words, Spike has {len(theirs)}"
    wrong = [i for i, pair in enumerate(zip(theirs, ours, strict=True)) if pair[0] != pair[1]]
    return f"word {wrong[0]} of {len(ours)} is {ours[wrong[0]]}, in Spike {theirs[wrong[0]]}" if wrong else None
