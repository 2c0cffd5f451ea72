#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of a tutorial as they are typed, in an empty home folder, with MEbots from a wheel (wheel_of.py).

Usage: tutorial.py SOURCES WHEEL_WORK NAME. The files that the page asks the reader to save are saved, and its changes to files are made,
at the place of the text where the page says so. Commands that cannot run here are listed below with the reason.
"""

import dataclasses
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time

# Beginnings of commands that do not run here, and why.
SKIPPED = {
    "first-flight": {
        "scripts/demo.sh": "builds the checkout",
        "cmake --install": "the wheel is here in its place",
        "/usr/bin/python3 -m venv": "wheel_of.py did it",
        "ln -s ~/drone": "the same with the folder of wheel_of.py",
        "mebots replay log00": "the logs are the reader's",
        "mebots identify log00": "the logs are the reader's",
    },
    "debugging": {
        "mebots run gate_easy.json --out results/held": "waits for gdb in another terminal; tests/tools has it",
        "gdb-multiarch": "the other terminal",
        "timeout -s INT": "its time depends on the machine; tests/interfaces interrupts runs",
        "mebots resume": "needs the interrupted run",
    },
    "own-network": {
        "mebots deploy mine.onnx": "the export needs PyTorch, which is 5 GB with its libraries; the page names the version that it was run with",
        "mebots sweep study.json --out results": "twelve hard missions take minutes; --dry-run before it checks the study",
    },
}
# Commands that fail on purpose: the page shows their errors.
FAILING = {
    "own-fmu": ["mebots test heater/test/heater.mebots-test.json"],
}


@dataclasses.dataclass
class Step:
    """A command, or a file to write."""

    command: str = ""
    file: str = ""
    content: str = ""


def saved_name(text):
    """Returns the file that a paragraph asks to save the following block as, or "replace"."""
    found = re.search(r"(?:[Ss]ave this as|replace) `([^`]+)`(?: next to it| by)?[^`]*:?$|[Ss]ave this as `([^`]+)`", text.replace("\n", " ").strip())
    return (found[1] or found[2]) if found else ""


def read_steps(page):
    """Returns the steps of a page in their order, and the remaining code blocks with their language."""
    steps, blocks = [], []
    paragraph, fence, block = [], None, []
    for line in page.read_text(encoding="utf-8").splitlines():
        opening = re.match(r"```(\w*)$", line)
        if fence is not None:
            if line == "```":
                name = saved_name(" ".join(paragraph))
                content = "\n".join(block) + "\n"
                if name and fence in ("json", "", "csv"):
                    steps.append(Step(file=name, content=content))
                elif fence not in ("none",):
                    blocks.append((len(steps), fence, content))
                fence, block, paragraph = None, [], []
            else:
                block.append(line)
        elif opening:
            fence = opening[1]
        elif line.startswith("    "):
            steps.append(Step(command=re.sub(r"\s{2,}#.*$", "", line.strip())))
            paragraph = []
        elif line.strip():
            paragraph.append(line)
        elif paragraph and not saved_name(" ".join(paragraph)):
            paragraph = []
    return steps, blocks


def edit_heater(steps, blocks):
    """The changes that own-fmu asks for in the generated model: constructor, start and step, the members, one more test."""
    code, members, test = (content for _, language, content in blocks if language == "cpp")
    script = f"""
import pathlib, re
model = pathlib.Path("heater/src/model.cpp")
text = model.read_text()
begin, end = text.index("namespace {{\\n"), text.index("void Model::write(")
model.write_text(text[:begin] + {code!r} + "\\n" + text[end:])
header = pathlib.Path("heater/src/model.hpp")
header.write_text(header.read_text().replace("  double time_constant_s_;\\n", {members!r}))
test = pathlib.Path("heater/test/model_test.cpp")
text = test.read_text()
end = text.rindex("}}  // namespace\\n")
test.write_text(text[:end] + {test!r} + "\\n" + text[end:])
"""
    at = next(i for i, step in enumerate(steps) if step.command.startswith("cmake -S heater"))
    return [*steps[:at], Step(file="edit.py", content=script), Step(command="python3 edit.py"), *steps[at:]]


def edit_network(steps, blocks):
    """The lines that own-network asks for in the firmware of `mebots new-firmware mine`."""
    recipe = next(content for _, language, content in blocks if language == "cmake")
    program = next(content for _, language, content in blocks if language == "c")
    script = f"""
import pathlib, re
recipe = pathlib.Path("mine/CMakeLists.txt")
recipe.write_text(re.sub(r"^mebots_add_firmware\\(.*?\\)\\n", lambda _: {recipe!r}, recipe.read_text(), flags=re.MULTILINE | re.DOTALL))
pathlib.Path("mine/main.c").write_text({program!r})
"""
    build = [Step(file="edit.py", content=script), Step(command="python3 edit.py"), Step(command="cmake -S mine -B mine/build"), Step(command="cmake --build mine/build")]
    return [*steps, *build]


EDITS = {"own-fmu": edit_heater, "own-network": edit_network}
# Tutorials begin where the first flight's "Install" ends.
FIRST = "ln -s {package} ~/mebots && mkdir -p ~/work && cd ~/work"


class Shell:
    """A bash that keeps its folder and variables from command to command."""

    def __init__(self, home, environment):
        self._shell = subprocess.Popen(["bash", "--norc"], cwd=home, env=environment, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def run(self, command):
        """Returns the exit code and what was printed."""
        end = "---end of command---"
        self._shell.stdin.write(f"{{ {command}\n}} </dev/null; status=$?; echo; echo '{end}' $status\n")
        self._shell.stdin.flush()
        lines = []
        for line in self._shell.stdout:
            if line.startswith(end):
                return int(line.split()[-1]), "".join(lines)
            lines.append(line)
        return 1, "".join([*lines, "the shell ended\n"])

    def close(self):
        self._shell.stdin.close()
        self._shell.wait()


def main():
    sources, work, name = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]
    steps, blocks = read_steps(sources / "docs/tutorials" / f"{name}.md")
    if name in EDITS:
        steps = EDITS[name](steps, blocks)
    unused = [start for start in SKIPPED.get(name, {}) if not any(step.command.startswith(start) for step in steps)]
    if unused:
        sys.exit(f"{name}: the page no longer has these commands: {', '.join(unused)}")
    failing = set(FAILING.get(name, []))
    with tempfile.TemporaryDirectory(prefix="mebots tutorial ") as folder:
        home = pathlib.Path(folder)
        package = next((work / "drone").glob("lib/python3.*/site-packages/mebots"))
        path = f"{work}/drone/bin:{home}/mebots/bin:/usr/local/bin:/usr/bin:/bin"
        kept = {key: os.environ[key] for key in ("CCACHE_DIR", "CMAKE_CXX_COMPILER_LAUNCHER", "CMAKE_C_COMPILER_LAUNCHER", "LANG") if key in os.environ}
        shell = Shell(home, kept | {"HOME": folder, "PATH": path})
        code, output = shell.run(FIRST.format(package=shlex.quote(str(package))))
        assert code == 0, output
        (home / "work/examples").symlink_to(sources / "examples")  # "from a checkout of MEbots"
        count, begin = 0, time.monotonic()
        for step in steps:
            if step.file:
                _, place = shell.run("pwd")
                (pathlib.Path(place.strip()) / step.file).write_text(step.content, encoding="utf-8")
                continue
            reason = next((why for start, why in SKIPPED.get(name, {}).items() if step.command.startswith(start) and "--dry-run" not in step.command), None)
            if reason is not None:
                print(f"not run: {step.command}: {reason}")
                continue
            start = time.monotonic()
            code, output = shell.run(step.command)
            count += 1
            print(f"{time.monotonic() - start:6.1f} s  {step.command}", flush=True)
            expected = next((one for one in failing if step.command.startswith(one)), None)
            failing.discard(expected)
            if (code != 0) != (expected is not None):
                sys.exit(f"{name}: exit code {code} of: {step.command}\n{output}")
        shell.close()
    if count == 0 or failing:
        sys.exit(f"{name}: {count} commands ran; these never failed, and the page says so: {sorted(failing)}")
    print(f"ok: {count} commands of {name} in {time.monotonic() - begin:.1f} s")


if __name__ == "__main__":
    main()
