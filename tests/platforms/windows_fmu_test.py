# SPDX-License-Identifier: Apache-2.0
"""Runs an FMU that only has a binary for Windows under wine. The results must be the same as on Linux. Every fault must be
contained and reported.

    windows_fmu_test.py MEBOTS FMI2_HEADER_FOLDER

Exit code 77 (skipped): wine, MinGW or mebots-windows-host.exe is missing.
"""

import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

MEBOTS, HEADERS = Path(sys.argv[1]), Path(sys.argv[2])
COMPILERS = {"linux64/probe.so": ["gcc", "-fPIC"], "win64/probe.dll": ["x86_64-w64-mingw32-gcc-posix"]}
VARIABLES = [("u", "0", "input", "continuous", "<Real start='0'/>"), ("y", "1", "output", "continuous", "<Real/>"),
             ("count", "0", "output", "discrete", "<Integer/>"), ("name", "0", "parameter", "fixed", "<String start=''/>"),
             ("fault", "1", "parameter", "fixed", "<String start=''/>"), ("text", "2", "output", "discrete", "<String/>"),
             ("line", "3", "output", "discrete", "<String/>")]
DESCRIPTION = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="probe" guid="{{p}}"><CoSimulation modelIdentifier="probe"/>
<LogCategories><Category name="console"/></LogCategories>
<ModelVariables>{"".join(f"<ScalarVariable name='{n}' valueReference='{r}' causality='{c}' variability='{v}'>{t}</ScalarVariable>"
                         for n, r, c, v, t in VARIABLES)}</ModelVariables>
<ModelStructure><Outputs><Unknown index="2"/><Unknown index="3"/><Unknown index="6"/><Unknown index="7"/></Outputs></ModelStructure>
</fmiModelDescription>"""


def missing():
    """Returns the names of missing packages that this test needs."""
    found = {"wine64": shutil.which("wine64") or shutil.which("wine") or Path("/usr/lib/wine/wine64").exists(),
             "g++-mingw-w64-x86-64-posix": shutil.which("x86_64-w64-mingw32-gcc-posix"),
             "mebots-windows-host.exe (build again with MinGW)": (MEBOTS.parent / "mebots-windows-host.exe").exists()}
    return [package for package, is_there in found.items() if not is_there]


class WindowsFmu(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="mebots windows f\u00fcr "))
        for name, compiler in COMPILERS.items():
            binary = cls.folder / Path(name).name
            subprocess.run([*compiler, "-std=c11", "-O1", "-shared", f"-I{HEADERS}", str(Path(__file__).with_name("windows_probe.c")), "-o",
                            str(binary)], check=True)
            (cls.folder / binary.suffix[1:]).mkdir()
            cls.pack(cls.folder / binary.suffix[1:] / "probe.fmu", name, binary)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @staticmethod
    def pack(archive, name, binary):
        with zipfile.ZipFile(archive, "w") as packed:
            packed.writestr("modelDescription.xml", DESCRIPTION)
            packed.writestr("resources/line.txt", "gr\u00fcn\n")
            packed.write(binary, "binaries/" + name)

    def run_fmu(self, kind, fault="", **keys):
        return self.run_instance({"fmu": f"{kind}/probe.fmu", "parameters": {"fault": fault, "name": "m\u00fc", "u": 0.3}, **keys}, "out_" + kind)

    def run_instance(self, instance, name):
        config = {"step": 0.1, "stop_time": 1, "instances": {"i": instance}, "record": {"texts": True}}
        (self.folder / "c.json").write_text(json.dumps(config))
        out = self.folder / name
        shutil.rmtree(out, ignore_errors=True)
        environment = dict(os.environ, TMPDIR=str(self.folder), WINDOWS_FMU_TEST=str(self.folder))
        done = subprocess.run([MEBOTS, "run", "c.json", "--out", str(out)], cwd=self.folder, env=environment, capture_output=True,
                              text=True, timeout=100, check=False)
        self.assertEqual(self.processes_left(), [], "a process of wine is left")
        return done, out

    def processes_left(self):
        found = []
        for process in Path("/proc").glob("[0-9]*"):
            try:
                if f"WINDOWS_FMU_TEST={self.folder}".encode() in (process / "environ").read_bytes():
                    found.append((process / "comm").read_text())
            except OSError:  # it has ended, or is not ours
                continue
        return found

    def test_results_and_messages_are_those_of_linux(self):
        files = {}
        for kind in ("so", "dll"):
            done, out = self.run_fmu(kind)
            self.assertEqual(done.returncode, 0, done.stderr)
            log = (out / "log.txt").read_text().splitlines()
            files[kind] = [(out / "results.csv").read_text()] + [line for line in log if "caf\u00e9" in line or "1.5 for {p}" in line]
        self.assertEqual(files["dll"], files["so"])
        self.assertIn("m\u00fc|10", files["dll"][0])
        self.assertIn("gr\u00fcn", files["dll"][0])
        self.assertEqual(len(files["dll"]), 4, "a message of fmi2Instantiate and two of fmi2DoStep")

    def test_it_runs_in_its_own_process_with_a_notice(self):
        done, _ = self.run_fmu("dll")
        self.assertIn("runs in its own process: it has a binary for Windows", done.stderr + done.stdout)

    def test_an_fmu_does_not_call_back_for_inputs_within_a_step(self):
        library = self.folder / "follower.dll"
        subprocess.run(["x86_64-w64-mingw32-g++-posix", "-std=c++20", "-O1", "-static", "-shared",
                        f"-I{HEADERS.parents[1] / 'modeldesc/include'}", str(HEADERS / "follower.cpp"), "-o", str(library)], check=True)
        with zipfile.ZipFile(self.folder / "follower.fmu", "w") as packed:
            packed.write(HEADERS / "follower.xml", "modelDescription.xml")
            packed.write(library, "binaries/x86_64-windows/follower.dll")
        done, out = self.run_instance({"fmu": "follower.fmu", "parameters": {"u[1]": 0.5}}, "out_follower")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("cannot call back for inputs within a step", done.stderr + done.stdout)
        with (out / "results.csv").open(newline="") as file:
            last = list(csv.DictReader(file))[-1]
        self.assertEqual(next(value for key, value in last.items() if key.startswith("i.updates")), "0")
        self.assertAlmostEqual(float(next(value for key, value in last.items() if key.startswith("i.x[1]"))), 0.5)

    def test_the_shared_process_is_refused(self):
        done, _ = self.run_fmu("dll", process="shared")
        self.assertEqual(done.returncode, 2)
        self.assertIn("binary for Windows", done.stderr)

    def test_the_sandbox_is_refused(self):
        done, _ = self.run_fmu("dll", process="sandboxed")
        self.assertEqual(done.returncode, 2)
        self.assertIn("wine does not run in a sandbox", done.stderr)

    def test_faults_are_reported_as_on_linux(self):
        texts = {"crash": ["SIGSEGV", "fmi2DoStep", "at address 0x1230"], "divide": ["SIGFPE", "fmi2DoStep"],
                 "stack": ["SIGSEGV", "its stack overflowed"], "exit": ["exit code 5 in fmi2DoStep"]}
        for fault, expected in texts.items():
            for kind in ("so", "dll"):
                with self.subTest(fault=fault, kind=kind):
                    done, out = self.run_fmu(kind, fault, process="own")
                    self.assertEqual(done.returncode, 1)
                    for text in expected:
                        self.assertIn(text, done.stderr)
                    self.assertIn("0.4", (out / "results.csv").read_text(), "rows before the fault are there")

    def test_an_exception_of_windows_is_named(self):
        done, _ = self.run_fmu("dll", "raise")
        self.assertEqual(done.returncode, 1)
        self.assertIn("0xe06d7363 (exception of C++)", done.stderr)
        self.assertIn("SIGABRT", done.stderr)

    def test_abort_ends_the_run(self):
        done, _ = self.run_fmu("dll", "abort")
        self.assertEqual(done.returncode, 1)
        self.assertIn("fmi2DoStep", done.stderr)

    def test_a_hang_is_ended_by_its_deadline(self):
        done, _ = self.run_fmu("dll", "hang", deadline=20)
        self.assertEqual(done.returncode, 1)
        self.assertIn("fmi2DoStep did not return within its deadline", done.stderr)

    def test_memory_is_limited(self):
        done, _ = self.run_fmu("dll", "memory", memory_limit_mb=200)
        self.assertEqual(done.returncode, 1)
        self.assertIn("SIGSEGV", done.stderr)

    def test_prints_go_to_standard_error(self):
        done, out = self.run_fmu("dll", "print")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("printed by the FMU", done.stderr)
        self.assertNotIn("printed", done.stdout)

    def test_a_locale_of_the_fmu_changes_no_results(self):
        results = []
        for fault in ("", "locale"):
            done, out = self.run_fmu("dll", fault)
            self.assertEqual(done.returncode, 0, done.stderr)
            results.append((out / "results.csv").read_text())
        self.assertEqual(*results)
        self.assertIn("locale: 1,5", done.stderr, "the FMU has set a locale with a decimal comma")

    def check(self, kind):
        """Runs `mebots check`. Returns the result and the findings of its check that runs the FMU under wine."""
        done = subprocess.run([MEBOTS, "check", "--json", f"{kind}/probe.fmu"], cwd=self.folder, capture_output=True, text=True, timeout=200,
                              check=False)
        plain = next(check for check in json.loads(done.stdout)["checks"] if "under wine" in check["name"])
        return plain["result"], json.dumps(plain["findings"])

    def test_check_makes_a_plain_run(self):
        self.assertEqual(self.check("dll"), ("passed", "[]"))

    def test_a_missing_dll_is_reported(self):
        broken = self.folder / "broken.dll"
        broken.write_bytes((self.folder / "probe.dll").read_bytes().replace(b"msvcrt.dll", b"nodll0.dll"))
        (self.folder / "broken").mkdir()
        self.pack(self.folder / "broken/probe.fmu", "win64/probe.dll", broken)
        done, _ = self.run_fmu("broken")
        self.assertEqual(done.returncode, 2)
        self.assertIn("it needs a DLL that was not found", done.stderr)
        result, findings = self.check("broken")
        self.assertEqual(result, "failed")
        self.assertIn("it needs a DLL that was not found", findings)


if __name__ == "__main__":
    if missing():
        print("skipped: not installed:", ", ".join(missing()))
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
