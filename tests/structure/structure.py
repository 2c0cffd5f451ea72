#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the include graph of the product with the order in layers.json.

    structure.py                 print violations of the order
    structure.py --list [PART]   print the dependencies between folders, with the number of includes
    structure.py --write         write the tables of layers into docs/architecture.md
"""
import argparse
import ast
import json
import re
import sys
from collections import defaultdict
from pathlib import Path, PurePosixPath

REPOSITORY = Path(__file__).resolve().parents[2]
ORDER = Path(__file__).resolve().with_name("layers.json")
PAGE = Path("docs/architecture.md")

INCLUDE = re.compile(r'^\s*#\s*include\s+["<]([^">]+)[">]', re.MULTILINE)
RAW_STRING = re.compile(r'R"(\w*)\(.*?\)\1"', re.DOTALL)
IMPORT_OF_TYPESCRIPT = re.compile(r'\bfrom\s+"(\.[^"]+)"')
ENDINGS = {".hpp", ".cpp", ".h", ".c"}


def components(graph):
    """Returns the strongly connected components of a graph {node: nodes}, by Tarjan's algorithm."""
    index, low, stack, on_stack, found = {}, {}, [], set(), []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        on_stack.add(node)
        for other in sorted(graph.get(node, ())):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in on_stack:
                low[node] = min(low[node], index[other])
        if low[node] != index[node]:
            return
        component = set()
        while node not in component:
            component.add(stack.pop())
        on_stack.difference_update(component)
        found.append(component)

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def cycles(graph):
    return [sorted(component) for component in components(graph) if len(component) > 1]


def includes_of(file):
    """Returns the names in the include lines of a file. Ignores the text of raw strings."""
    return INCLUDE.findall(RAW_STRING.sub("", file.read_text(encoding="utf-8")))


class Part:
    """A part of the product in C or C++: its files, and the folders for its includes."""

    def __init__(self, root, name, description):
        self.name = name
        self.uses = description["uses"]
        self.also = {PurePosixPath(name) / file: parts for file, parts in description.get("also", {}).items()}
        self.layers = description.get("layers")
        self.known_cycles = [sorted(PurePosixPath(name) / folder for folder in cycle)
                             for cycle in description.get("known_cycles", [])]
        self.paths = [PurePosixPath(name) / path for path in description["include_paths"]]
        self.public = [PurePosixPath(name) / path for path in description.get("public", [])]
        left_out = [PurePosixPath(name) / path for path in description.get("left_out", [])]
        files = (PurePosixPath(file.relative_to(root)) for file in (root / name).rglob("*") if file.suffix in ENDINGS)
        self.files = {file for file in files if not any(file.is_relative_to(folder) for folder in left_out)}

    def is_public(self, file):
        return any(file.is_relative_to(folder) for folder in self.public)

    def layer(self, folder):
        """Returns (index of the folder's layer, the layer's entry that contains the folder). Index 0 is the lowest layer. If
        several entries contain the folder, the longest entry counts. If no entry contains it, returns None.
        """
        found = None
        for place, layer in enumerate(self.layers):
            for entry in layer["folders"]:
                inside = folder.is_relative_to(PurePosixPath(self.name) / entry)
                if inside and (found is None or len(entry) > len(found[1])):
                    found = (place, entry)
        return found


class Structure:
    def __init__(self, root, order):
        self.root = root
        self.order = order
        self.parts = {name: Part(root, name, part) for name, part in order["parts"].items()}
        self.owners = {file: part for part in self.parts.values() for file in part.files}
        self.includes = [(file, name, self.find(file, name)) for file in sorted(self.owners)
                         for name in includes_of(root / file)]

    def find(self, file, name):
        """Returns the file that `file` includes under this name. If that file is not part of MEbots, returns None."""
        part = self.owners[file]
        paths = [file.parent, *part.paths, *(path for other in self.parts.values() for path in other.paths)]
        for path in paths:
            parts = []
            for step in (path / name).parts:
                parts = parts[:-1] if step == ".." else [*parts, step]
            if (candidate := PurePosixPath(*parts)) in self.owners:
                return candidate
        return None

    def dependencies(self, name):
        """Returns {(folder, folder): [(file, file)]} for the includes from one folder of a part to another."""
        found = defaultdict(list)
        for file, _, target in self.includes:
            if target is None or self.owners[file].name != name or self.owners[target].name != name:
                continue
            if file.parent != target.parent:
                found[file.parent, target.parent].append((file, target))
        return found

    def mistakes(self):
        found = [*self.mistakes_between_parts(), *self.mistakes_of_public_headers()]
        for part in self.parts.values():
            if part.layers is not None:
                found += [*self.mistakes_of_order(part), *self.mistakes_of_cycles(part)]
        for modules in self.order["modules"]:
            found += mistakes_of_modules(self.root, modules)
        return found

    def mistakes_between_parts(self):
        for file, _, target in self.includes:
            if target is None:
                continue
            source, other = self.owners[file], self.owners[target]
            if source is not other and other.name not in [*source.uses, *source.also.get(file, [])]:
                yield f"{file} includes {target}, but {source.name} must not use {other.name}"

    def mistakes_of_public_headers(self):
        for file, name, target in self.includes:
            if self.owners[file].is_public(file) and target is not None and not self.owners[target].is_public(target):
                yield f"{file} is public and includes the private {target}"

    def mistakes_of_order(self, part):
        for file in sorted(part.files):
            if part.layer(file.parent) is None:
                yield f"{file}: no layer of {part.name} names its folder"
        for (folder, other), pairs in sorted(self.dependencies(part.name).items()):
            source, target = part.layer(folder), part.layer(other)
            if source is None or target is None or target[0] < source[0] or target == source:
                continue
            if any(folder in cycle and other in cycle for cycle in part.known_cycles):
                continue
            file, included = pairs[0]
            yield f"{folder} must not use {other}: {file} includes {included}" + (
                f", and {len(pairs) - 1} more" if len(pairs) > 1 else "")

    def mistakes_of_cycles(self, part):
        graph = defaultdict(set)
        pairs = self.dependencies(part.name)
        for folder, other in pairs:
            graph[folder].add(other)
        found = cycles(graph)
        for cycle in part.known_cycles:
            if cycle not in found:
                yield f"{part.name}: remove the known cycle {', '.join(map(str, cycle))} from {ORDER.name}: it is gone"
        for cycle in found:
            if cycle in part.known_cycles:
                continue
            examples = ", ".join(f"{file} includes {included}"
                                 for (folder, other), [(file, included), *_] in sorted(pairs.items())
                                 if folder in cycle and other in cycle)
            yield f"folders of {part.name} form a cycle: {', '.join(map(str, cycle))}: {examples}"


def imports_of_python(root, file):
    """Returns the modules of the package in `root` that a module imports. Ignores imports of a package's __init__, which only
    re-exports names."""
    known = {path.relative_to(root).with_suffix("") for path in root.rglob("*.py")}
    here = file.relative_to(root).parent
    candidates = []
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            path = Path(*(node.module or "").split("."))
            if node.level:
                path = Path(*here.parts[:len(here.parts) - node.level + 1]) / path
            elif path.parts and path.parts[0] == root.name:
                path = Path(*path.parts[1:])
            else:
                continue
            candidates += [path, *(path / alias.name for alias in node.names)]
        elif isinstance(node, ast.Import):
            names = (alias.name.split(".") for alias in node.names)
            candidates += [Path(*name[1:]) for name in names if name[0] == root.name]
    return {path.as_posix() for path in candidates if path in known}


def imports_of_typescript(root, file):
    here = file.parent
    found = set()
    for name in IMPORT_OF_TYPESCRIPT.findall(file.read_text(encoding="utf-8")):
        path = (here / name).resolve()
        if path.with_name(path.name + ".ts").is_file():
            found.add(path.relative_to(root.resolve()).as_posix())
    return found


def mistakes_of_modules(root, description):
    """Checks that the modules of a folder do not import each other in a cycle. Yields the violations."""
    folder = root / description["root"]
    ending, imports = {"python": (".py", imports_of_python),
                       "typescript": (".ts", imports_of_typescript)}[description["language"]]
    graph = {}
    for file in sorted(folder.rglob("*" + ending)):
        graph[file.relative_to(folder).with_suffix("").as_posix()] = imports(folder, file)
    for cycle in cycles(graph):
        yield f"modules of {description['root']} form a cycle: {', '.join(cycle)}"


def table(part):
    """Returns the layers of a part as a Markdown table, from the top layer down."""
    lines = ["| layer | contents |", "|---|---|"]
    for layer in reversed(part.layers):
        folders = ", ".join(f"`{folder}/`" for folder in layer["folders"])
        lines.append(f"| {folders} | {layer['what']} |")
    return "\n".join(lines)


def marks(part):
    return f"<!-- layers of {part.name}, from tests/structure/layers.json -->\n", "\n<!-- end of layers -->"


def page_with_tables(structure, page):
    for part in structure.parts.values():
        if part.layers is None:
            continue
        begin, end = marks(part)
        if begin not in page:
            raise ValueError(f"{PAGE} has no place for the layers of {part.name}: add the lines\n{begin}{end}")
        before, rest = page.split(begin, 1)
        page = before + begin + table(part) + end + rest.split(end, 1)[1]
    return page


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", nargs="?", const="", metavar="PART")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    structure = Structure(REPOSITORY, json.loads(ORDER.read_text(encoding="utf-8")))
    if options.list is not None:
        for name in [options.list] if options.list else structure.parts:
            for (folder, other), pairs in sorted(structure.dependencies(name).items()):
                print(f"{folder} -> {other}: {len(pairs)}")
        return 0
    if options.write:
        page = REPOSITORY / PAGE
        page.write_text(page_with_tables(structure, page.read_text(encoding="utf-8")), encoding="utf-8")
        return 0
    mistakes = structure.mistakes()
    print("\n".join(mistakes) or "the include graph follows the order")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
