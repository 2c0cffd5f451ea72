# SPDX-License-Identifier: Apache-2.0
"""```{schema} mebots-config```: inserts tables of the keys of a JSON schema in configs/schemas, one for each kind of object."""

import json
from pathlib import Path

from sphinx.util.docutils import SphinxDirective


def target_of(schema, whole):
    """Returns the schema, or the definition to which it refers; and the name of that definition."""
    if "$ref" not in schema:
        return schema, None
    path = schema["$ref"].removeprefix("#/").split("/")
    found = whole
    for key in path:
        found = found[key]
    return found, path[-1]


def limits_of(schema):
    words = []
    for key, sign in (("minimum", "≥"), ("exclusiveMinimum", ">"), ("maximum", "≤"), ("exclusiveMaximum", "<")):
        if key in schema:
            words.append(f"{sign} {schema[key]:g}")
    if "pattern" in schema and len(schema["pattern"]) < 30:
        words.append(f"`{schema['pattern']}`")
    return (" " + ", ".join(words)) if words else ""


def type_of(schema, whole, anchors, around=()):
    """Describes a value in words. `around` are the enclosing definitions; a recursive definition is represented by its name."""
    target, name = target_of(schema, whole)
    if name in anchors:
        return f"[{name}](#{anchors[name]})"
    if name in around:
        return name.replace("_", " ")
    around = (*around, name) if name else around
    if "const" in target:
        return f"`{json.dumps(target['const'])}`"
    if "enum" in target:
        return ", ".join(f"`{json.dumps(item)}`" for item in target["enum"])
    for key in ("anyOf", "oneOf"):
        if key in target:
            return " or ".join(dict.fromkeys(type_of(part, whole, anchors, around) for part in target[key] if part != {"type": "null"}))
    kind = target.get("type", "object" if "properties" in target else "any")
    if isinstance(kind, list):
        return " or ".join(kind)
    if kind == "array" and isinstance(target.get("items"), dict):
        return "list of " + type_of(target["items"], whole, anchors, around)
    if kind == "object" and isinstance(target.get("additionalProperties"), dict):
        return "names → " + type_of(target["additionalProperties"], whole, anchors, around)
    return kind + limits_of(target)


def properties_of(schema):
    """Returns all keys that an object may have, including those of its alternatives."""
    keys = dict(schema.get("properties", {}))
    for group in ("anyOf", "oneOf", "allOf"):
        for part in schema.get(group, []):
            for key, value in properties_of(part).items():
                keys.setdefault(key, value)
    return keys


def cell(text):
    return text.replace("|", "\\|").replace("\n", " ").replace("<", "\\<") if text else ""


def table_of(schema, whole, anchors):
    rows = ["| key | value | meaning |", "|---|---|---|"]
    required = schema.get("required") or schema.get("else", {}).get("required", [])
    for key, value in properties_of(schema).items():
        if value is False or key == "$schema":
            continue
        value = {} if value is True else value
        text = value.get("description") or target_of(value, whole)[0].get("description", "")
        mark = " *" if key in required else ""
        rows.append(f"| `{key}`{mark} | {cell(type_of(value, whole, anchors))} | {cell(text)} |")
    return "\n".join(rows)


def pages_of(whole, title):
    prefix = whole["$id"].rsplit("/", 1)[1].split(".")[0]
    objects = {name: part for name, part in whole.get("$defs", {}).items() if len(properties_of(part)) > 1}
    anchors = {name: f"{prefix}-{name}".replace("_", "-").lower() for name in objects}
    parts = [f"## {title}", "", whole.get("description", "").replace("<", "\\<"), "", table_of(whole, whole, anchors), ""]
    for name, part in objects.items():
        parts += [f"({anchors[name]})=", f"### {title}: `{name}`", "", cell(part.get("description", "")), "", table_of(part, whole, anchors), ""]
    return "\n".join(parts)


class Schema(SphinxDirective):
    required_arguments = 1
    has_content = False

    def run(self):
        file = Path(self.env.srcdir) / "configs/schemas" / f"{self.arguments[0]}.schema.json"
        self.env.note_dependency(str(file))
        whole = json.loads(file.read_text())
        title = whole["title"].removeprefix("MEbots ")
        return self.parse_text_to_nodes(pages_of(whole, title[0].upper() + title[1:]), allow_section_headings=True)


def setup(app):
    app.add_directive("schema", Schema)
    return {"parallel_read_safe": True}
