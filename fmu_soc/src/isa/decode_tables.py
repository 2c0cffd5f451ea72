#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes C++ tables from the tables of instructions (*.decode): operations, formats, encodings, and which pair of
functions each operation has. instructions.md describes the rows.

    decode_tables.py FOLDER formats.decode FAMILY.decode...
"""

import pathlib
import re
import sys

LONGEST_ROW = 120
EXCLUSIVE = {"f", "zfinx"}  # no core has both extensions, so their rows may overlap
KEYWORDS = {"and", "or", "xor", "not"}  # of C++
DEFAULT = {"reserved": "never", "value": "as_it_is", "operand": "reg"}
TRAITS = {  # in the order of OpTraits, with how a value is written
    "kind": "OpKind::{}", "size": "{}", "parts": "{}", "sign": "{}", "mode": "AddressMode::{}",
    "relation": "Relation::{}", "second_sign": "{}", "reads_rd": "{}", "rounds": "{}", "subtracts": "{}",
    "high": "{}", "ends_block": "{}", "cycles": "{}", "reads_rs2": "{}", "atomic": "{}", "floats": "{}",
}


class Mistake(Exception):
    pass


def attributes(words):
    """Returns attributes such as `size=2 sign` as a dictionary."""
    pairs = (word.partition("=") for word in words)
    return {name: value if equals else "true" for name, equals, value in pairs}


class Tables:
    def __init__(self):
        self.fields = {}    # name -> C++ value
        self.formats = {}   # name -> attributes and text
        self.classes = {}   # name -> attributes
        self.operations = {}  # name -> attributes, in the order of the enumeration
        self.encodings = []
        self.families = []

    def read(self, path):
        family = path.stem
        extension = "standard"
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            try:
                if len(line) > LONGEST_ROW:
                    raise Mistake(f"a row has {len(line)} columns; the most is {LONGEST_ROW}")
                if not line or line.startswith("#"):
                    continue
                first, *rest = line.split()
                if first == "%extension":
                    extension = rest[0]
                elif first[0] == "%":
                    self.add_field(first[1:], rest)
                elif first[0] == "@":
                    self.add_format(first[1:], line)
                elif first[0] == "&":
                    self.classes[first[1:]] = attributes(rest)
                else:
                    self.add_row(family, extension, line, f"{path.name}:{number}")
            except Mistake as mistake:
                sys.exit(f"{path}:{number}: {mistake}")

    def add_field(self, name, words):
        kind, *pieces = words
        if kind == "register":
            bits = next((piece for piece in pieces if piece[0].isdigit()), None)
            added = next((piece[1:] for piece in pieces if piece[0] in "+="), "0")
            high, low = (0, 1) if bits is None else bit_range(bits)
            self.fields[name] = f"RegisterField{{{max(low, 0) if bits else 0}, {high - low + 1}, {added}}}"
            return
        cpp, top = [], 0
        for piece in pieces:
            bits, _, to = piece.partition(">")
            high, low = bit_range(bits)
            cpp.append(f"{{{high}, {low}, {to or 0}}}")
            top = max(top, high - low + int(to or 0))
        sign = f", {top}" if kind == "signed" else ""
        self.fields[name] = f"Immediate({{{', '.join(cpp)}}}{sign})"

    def add_format(self, name, line):
        text = re.search(r'"(.*)"$', line)
        words = line[:text.start()] if text else line
        row = attributes(words.split()[1:])
        row["text"] = " " + text[1] if text else ""
        self.formats[name] = row

    def add_row(self, family, extension, line, place):
        mnemonic, rest = line.split(None, 1)
        bits = re.match(r"(-|[01. ]+?) +(?:@(\w+)|-)", rest)
        if not bits:
            raise Mistake(f"'{mnemonic}' has no encoding of 0, 1 and ., or no @format")
        format_name, words = bits[2], rest[bits.end():].split()
        operation = default_name(mnemonic)
        if words[:1] == ["="]:
            operation, words = words[1], words[2:]
            if not words and operation not in self.operations:
                raise Mistake(f"no operation {operation} above this row")
        self.add_operation(operation, words, family)
        pattern = bits[1].replace(" ", "")
        if pattern == "-":
            return
        if format_name not in self.formats:
            raise Mistake(f"no format @{format_name}")
        if len(pattern) != (16 if format_name.startswith("c_") else 32):
            raise Mistake(f"an encoding of @{format_name} has {len(pattern)} bits")
        mask = int(re.sub("[01]", "1", pattern).replace(".", "0"), 2)
        match = int(pattern.replace(".", "0"), 2)
        self.refuse_overlap(mnemonic, format_name, len(pattern), mask, match, extension)
        self.operations[operation]["operands"].add(self.formats[format_name].get("operand", "reg"))
        self.encodings.append({"mnemonic": mnemonic, "operation": operation, "format": format_name, "mask": mask,
                               "match": match, "bits": len(pattern), "extension": extension, "place": place})

    def add_operation(self, name, words, family):
        if name in self.operations:
            if words:
                raise Mistake(f"operation {name} has its class in another row")
            return
        row = {"family": family, "operands": set()}
        if words and words[0].startswith("&"):
            if words[0][1:] not in self.classes:
                raise Mistake(f"no class {words[0]}")
            row.update(self.classes[words[0][1:]])
            words = words[1:]
        row.update(attributes(words))
        unknown = set(row) - set(TRAITS) - {"by", "interpreted", "family", "operands"}
        if unknown:
            raise Mistake(f"unknown: {', '.join(sorted(unknown))}")
        self.operations[name] = row
        if family not in self.families:
            self.families.append(family)

    def refuse_overlap(self, mnemonic, format_name, bits, mask, match, extension):
        """Raises Mistake if a word matches this row and an earlier row, unless one of them has reserved operands, or no
        core has the extensions of both."""
        for other in self.encodings:
            common = mask & other["mask"]
            if {extension, other["extension"]} == EXCLUSIVE:
                continue
            if bits != other["bits"] or match & common != other["match"] & common:
                continue
            if "reserved" in self.formats[format_name] or "reserved" in self.formats[other["format"]]:
                continue
            raise Mistake(f"'{mnemonic}' overlaps '{other['mnemonic']}' ({other['place']})")

    def traits(self, name):
        row = self.operations[name]
        values = (f".{key} = {cpp.format(row[key])}" for key, cpp in TRAITS.items() if key in row)
        return f"OpTraits{{{', '.join(values)}}},  // {name}"

    def format_row(self, name):
        row = self.formats[name]
        values = [f".bytes = {2 if name.startswith('c_') else 4}"]
        for key, member in (("rd", "rd"), ("rs1", "rs1"), ("rs2", "rs2"), ("rs3", "rs3"), ("imm", "immediate")):
            if key in row:
                values.append(f".{member} = {self.fields[row[key][1:]]}")
        for key in ("operand", "value", "reserved"):
            values.append(f".{key} = {key.capitalize()}::{row.get(key, DEFAULT[key])}")
        values.append(f'.text = "{row["text"]}"')
        return f"FormatRow{{{', '.join(values)}}},  // {name}"

    def encoding(self, row):
        return (f'Encoding{{"{row["mnemonic"]}", Op::{row["operation"]}, Format::{row["format"]}, '
                f'0x{row["mask"]:08x}, 0x{row["match"]:08x}, Extension::{row["extension"]}}},')

    def pair(self, name):
        """Returns the C++ code that creates an operation. With the key `by`, its execute function is a template."""
        row = self.operations[name]
        functions = row.get("by", name.removesuffix("_"))
        execute = f"execute_{functions}" + (f"<Op::{name}>" if "by" in row else "")
        operands = "".join(f", Operand::{operand}" for operand in sorted(row["operands"]))
        lowering = "nullptr" if "interpreted" in row else f"MEBOTS_LOWERING(emit_{functions})"
        return f"operation<Op::{name}, {execute}{operands}>({lowering}),"

    def files(self):
        yield "op_enum.inc", (f"{name}," for name in self.operations)
        yield "op_traits.inc", map(self.traits, self.operations)
        yield "op_names.inc", (f'"{name} "' for name in self.operations)
        yield "format_enum.inc", (f"{name}," for name in self.formats)
        yield "format_rows.inc", map(self.format_row, self.formats)
        yield "encodings.inc", map(self.encoding, self.encodings)
        members = {family: [name for name, row in self.operations.items() if row["family"] == family]
                   for family in self.families}
        for family, names in members.items():
            yield f"{family}.inc", map(self.pair, names)
        yield "families.inc", (f"MEBOTS_FAMILY({family}, {len(names)})" for family, names in members.items())


def bit_range(bits):
    high, _, low = bits.partition(":")
    return int(high), int(low or high)


def default_name(mnemonic):
    name = mnemonic.replace(".", "_")
    return name + "_" if name in KEYWORDS else name


def main():
    folder = pathlib.Path(sys.argv[1])
    tables = Tables()
    for path in sys.argv[2:]:
        tables.read(pathlib.Path(path))
    folder.mkdir(parents=True, exist_ok=True)
    for name, lines in tables.files():
        text = "// Written by decode_tables.py.\n" + "".join(f"{line}\n" for line in lines)
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
