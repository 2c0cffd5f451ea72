# SPDX-License-Identifier: Apache-2.0
"""```{fmu-variables} fmu_battery```: lists the variables in an FMU's modelDescription.xml by causality."""

import os
import zipfile
from pathlib import Path
from xml.etree import ElementTree

from sphinx.util.docutils import SphinxDirective

CAUSALITIES = {"parameter": "Parameters", "input": "Inputs", "output": "Outputs", "local": "Local variables"}


def cell(text):
    return text.replace("|", "\\|").replace("<", "\\<").replace("*", "\\*")


def row_of(variable, enumerations):
    kind = variable[0]
    unit = kind.get("unit", "")
    least, most = kind.get("min"), kind.get("max")
    limits = f"{least} to {most}" if least and most else f"≥ {least}" if least else f"≤ {most}" if most else ""
    start = kind.get("start", "")
    name = kind.tag
    if name == "Enumeration":
        items = enumerations.get(kind.get("declaredType"), {})
        name = ", ".join(items.values())
        start, limits = items.get(start, start), ""
    shown = f"`{start[:40]}`" if start else ""
    return f"| `{variable.get('name')}` | {name} | {unit} | {shown} | {limits} | {cell(variable.get('description', ''))} |"


def markdown(description):
    enumerations = {
        kind.get("name"): {item.get("value"): item.get("name") for item in kind.iter("Item")} for kind in description.iter("SimpleType")
    }
    parts = [f"## {description.get('modelName')}", "", description.get("description", "") + ".", ""]
    variables = list(description.find("ModelVariables"))
    for causality, title in CAUSALITIES.items():
        of_kind = [variable for variable in variables if variable.get("causality", "local") == causality]
        if of_kind:
            parts += [f"### {title} of {description.get('modelName')}", ""]
            parts += ["| name | type | unit | start | limits | meaning |", "|---|---|---|---|---|---|"]
            parts += [row_of(variable, enumerations) for variable in of_kind] + [""]
    return "\n".join(parts)


class FmuVariables(SphinxDirective):
    required_arguments = 1
    has_content = False

    def run(self):
        file = Path(os.environ["MEBOTS_DOCS_BUILD"]) / "fmus" / f"{self.arguments[0]}.fmu"
        self.env.note_dependency(str(file))
        with zipfile.ZipFile(file) as archive:
            description = ElementTree.fromstring(archive.read("modelDescription.xml"))
        return self.parse_text_to_nodes(markdown(description), allow_section_headings=True)


def setup(app):
    app.add_directive("fmu-variables", FmuVariables)
    return {"parallel_read_safe": True}
