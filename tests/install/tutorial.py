#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of a tutorial as a user would, in an empty home folder, with MEbots from a wheel (wheel_of.py).

Usage: tutorial.py SOURCES WHEEL_WORK NAME. Also saves the files that the page asks the reader to save, and makes the page's
changes to files, in the order of the text. SKIPPED lists commands that cannot run here, with the reason. The code of a notebook
runs as one program.

Exit code 77: this machine lacks something that the tutorial needs. `MEBOTS_CHECKOUTS` is the path of a folder with the
repositories that a page clones.
"""

import dataclasses
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time

# Maps the start of a command that cannot run here to the reason.
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
        "mebots sweep study.json --out results": "twelve hard missions take minutes; --dry-run before it checks the study",
    },
}
# These commands are also skipped if /usr/bin/python3 has no PyTorch, which takes 5 GB with its libraries.
WITHOUT_TORCH = {"mebots deploy mine.onnx": "the export before it needs PyTorch (setup.sh training); the page names the version that it was run with"}
SKIPPED["cflib"] = {
    "pip install cflib": "the environment has it",
    "CFLIB_URI=": "the example is cflib's; tests/link flies it. The page's own script runs in its place",
}
# The page shows that these commands fail.
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
    """Returns the name of the file that a paragraph asks the reader to save or replace with the following block. If it does not
    ask for this, returns an empty text.
    """
    found = re.search(r"(?:[Ss]ave this as|replace) `([^`]+)`(?: next to it| by)?[^`]*:?$|[Ss]ave this as `([^`]+)`", text.replace("\n", " ").strip())
    return (found[1] or found[2]) if found else ""


def read_steps(page):
    """Returns the steps of a page in order, and the remaining code blocks with their language."""
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


def read_notebook(page):
    """Returns one program of all code cells."""
    cells = json.loads(page.read_text(encoding="utf-8"))["cells"]
    code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    return [Step(file="notebook.py", content=code + "\n"), Step(command="MPLBACKEND=agg python3 notebook.py")]


def edit_heater(steps, blocks):
    """Returns the steps with the page's changes to own-fmu's generated model: constructor, start and step, the members, and
    another test.
    """
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


def torch_version():
    """Returns the version of the PyTorch of /usr/bin/python3; 0 if PyTorch is missing."""
    asked = subprocess.run(["/usr/bin/python3", "-c", "import torch; print(torch.__version__)"], capture_output=True, text=True)
    return int(asked.stdout.split(".")[0]) if asked.returncode == 0 else 0


def edit_network(steps, blocks):
    """Returns the steps with the page's lines in the firmware of `mebots new-firmware mine`. If PyTorch is available, also
    includes the export.
    """
    recipe = next(content for _, language, content in blocks if language == "cmake")
    program = next(content for _, language, content in blocks if language == "c")
    export = next(content for _, language, content in blocks if language == "python")
    script = f"""
import pathlib, re
recipe = pathlib.Path("mine/CMakeLists.txt")
recipe.write_text(re.sub(r"^mebots_add_firmware\\(.*?\\)\\n", lambda _: {recipe!r}, recipe.read_text(), flags=re.MULTILINE | re.DOTALL))
pathlib.Path("mine/main.c").write_text({program!r})
"""
    build = [Step(file="edit.py", content=script), Step(command="python3 edit.py"), Step(command="cmake -S mine -B mine/build"), Step(command="cmake --build mine/build")]
    version = torch_version()
    if version == 0:
        SKIPPED["own-network"] |= WITHOUT_TORCH
        return [*steps, *build]
    if version == 1:  # as the page says
        export = export.replace(", dynamo=False", "")
    pictures = """
import pathlib, numpy
from PIL import Image
pathlib.Path("pictures").mkdir()
for i, picture in enumerate(numpy.load("networks/sight.npy")[:20]):
    Image.fromarray(picture.reshape(picture.shape[-2:]).astype("uint8")).save(f"pictures/{i}.png")
"""
    first = [Step(file="export.py", content=export), Step(command="/usr/bin/python3 export.py"), Step(file="pictures.py", content=pictures), Step(command="python3 pictures.py")]
    at = next(i for i, step in enumerate(steps) if step.command.startswith("mebots deploy mine.onnx"))
    return [*steps[:at], *first, *steps[at:], *build]


def edit_cflib(steps, blocks):
    """Returns steps that start the drone in the background, run the page's script, and end the drone with SIGINT, as Ctrl-C does.
    Later `mebots link` steps end after 3 s."""
    script = next(content for _, language, content in blocks if language == "python")
    fly = [Step(file="fly.py", content=script), Step(command="python3 fly.py"), Step(command="kill -INT $drone; wait $drone")]
    waiting = [step for step in steps if step.command.startswith("mebots link") and "--replay" not in step.command]
    background = {id(step): Step(command=f"set -m; {step.command} & drone=$!; set +m; sleep 2") for step in waiting[:1]}
    ended = {id(step): Step(command=f"timeout --signal=INT 3 {step.command}; test $? -eq 124") for step in waiting[1:]}
    steps = [(background | ended).get(id(step), step) for step in steps]
    at = next(i for i, step in enumerate(steps) if step.command.startswith("CFLIB_URI="))
    return [*steps[: at + 1], *fly, *steps[at + 1 :]]


def edit_gap8(steps, _):
    """Returns the steps with links to the repositories in MEBOTS_CHECKOUTS. The links replace the page's commands that clone the
    repositories.
    """
    checkouts = os.environ.get("MEBOTS_CHECKOUTS")
    edited = []
    for step in steps:
        clone = re.fullmatch(r"git clone https://github\.com/[\w-]+/([\w-]+)", step.command)
        if clone and not (checkouts and (pathlib.Path(checkouts) / clone[1]).is_dir()):
            print(f"skipped: {step.command}: nothing is downloaded here; MEBOTS_CHECKOUTS names a folder with a checkout {clone[1]}")
            sys.exit(77)
        edited.append(Step(command=f"ln -s {shlex.quote(checkouts)}/{clone[1]} .") if clone else step)
    return edited


EDITS = {"own-fmu": edit_heater, "own-network": edit_network, "cflib": edit_cflib, "gap8": edit_gap8}
# Creates the state at the end of the section "Install" of the first flight, because the other tutorials start there.
FIRST = "ln -s {package} ~/mebots && mkdir -p ~/work && cd ~/work"


class Shell:
    """A bash that keeps its folder and variables from command to command."""

    def __init__(self, home, environment):
        self._shell = subprocess.Popen(["bash", "--norc"], cwd=home, env=environment, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def run(self, command):
        """Runs a command. Returns the exit code and the output."""
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
    if name == "notebook":
        steps = read_notebook(sources / "docs/tutorials/notebook.ipynb")
    else:
        steps, blocks = read_steps(sources / "docs/tutorials" / f"{name}.md")
        steps = EDITS.get(name, lambda steps, _: steps)(steps, blocks)
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
