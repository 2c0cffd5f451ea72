# SPDX-License-Identifier: Apache-2.0
"""Checks that the bills of materials (SPDX 2.3 JSON) of FMUs and of the installation are complete, and list the same parts as the
licence files next to them.

Usage: sbom_check.py INSTALLATION.spdx.json FMU... ; if the package spdx-tools is installed, its validator runs too.
"""

import json
import pathlib
import re
import sys
import tempfile
import zipfile

BILL = "documentation/sbom.spdx.json"
LICENSES = "documentation/licenses/"
RELATIONS = {"DESCRIBES", "STATIC_LINK", "CONTAINS", "DEPENDS_ON"}


def require(holds, what):
    if not holds:
        sys.exit(f"sbom_check: {what}")


def check(text, where):
    """Checks the requirements of SPDX 2.3 on MEbots' documents (clauses 6, 7 and 11), and that each used id is defined. Returns
    the packages."""
    bill = json.loads(text)
    require(bill["spdxVersion"] == "SPDX-2.3" and bill["dataLicense"] == "CC0-1.0", f"{where}: not SPDX 2.3")
    require(bill["SPDXID"] == "SPDXRef-DOCUMENT" and bill["name"], f"{where}: the document has no name")
    require(re.fullmatch(r"https://[^#\s]+-[0-9a-f]{64}", bill["documentNamespace"]), f"{where}: name space")
    require(re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", bill["creationInfo"]["created"]), f"{where}: time")
    require(all(re.match(r"(Tool|Person|Organization): \S", each) for each in bill["creationInfo"]["creators"]), f"{where}: creators")
    ids = [package["SPDXID"] for package in bill["packages"]]
    require(len(ids) == len(set(ids)), f"{where}: an id occurs twice")
    for package in bill["packages"]:
        require(re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", package["SPDXID"]), f"{where}: id {package['SPDXID']}")
        require(package["name"] and package["downloadLocation"] and package["filesAnalyzed"] is False, f"{where}: {package['name']}")
        for key in ("licenseConcluded", "licenseDeclared"):
            require(re.fullmatch(r"NOASSERTION|[A-Za-z0-9.+() -]+", package[key]), f"{where}: {package['name']}: {package[key]}")
        for reference in package.get("externalRefs", []):
            require(re.fullmatch(r"pkg:(deb/debian|npm)/[^\s@]+@\S+", reference["referenceLocator"]), f"{where}: {reference}")
    known = {"SPDXRef-DOCUMENT", *ids}
    for relation in bill["relationships"]:
        require(relation["relationshipType"] in RELATIONS, f"{where}: {relation}")
        require({relation["spdxElementId"], relation["relatedSpdxElement"]} <= known, f"{where}: {relation}")
    related = {relation["relatedSpdxElement"] for relation in bill["relationships"]}
    require(set(ids) <= related, f"{where}: a package is related to nothing")
    return bill["packages"]


def run_validator(text, where):
    try:
        from spdx_tools.spdx.parser.parse_anything import parse_file
        from spdx_tools.spdx.validation.document_validator import validate_full_spdx_document
    except ImportError:
        return False
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "sbom.spdx.json"
        file.write_text(text, encoding="utf-8")
        messages = [message.validation_message for message in validate_full_spdx_document(parse_file(str(file)))]
    require(not messages, f"{where}: {messages}")
    return True


def main():
    installation, *fmus = map(pathlib.Path, sys.argv[1:])
    text = installation.read_text(encoding="utf-8")
    whole = {package["name"] for package in check(text, installation.name)}
    validated = run_validator(text, installation.name)
    for fmu in fmus:
        with zipfile.ZipFile(fmu) as archive:
            text = archive.read(BILL).decode("utf-8")
            texts = {name.removeprefix(LICENSES).removesuffix(".txt") for name in archive.namelist() if name.startswith(LICENSES)}
        itself, *parts = check(text, fmu.name)
        require(itself["name"] == fmu.stem and itself["licenseDeclared"] == "Apache-2.0", f"{fmu.name}: itself is {itself}")
        names = {package["name"] for package in parts}
        require(names == texts - {"license"}, f"{fmu.name}: parts {sorted(names)}, licences {sorted(texts)}")
        require(all(package["licenseDeclared"] != "NOASSERTION" for package in parts), f"{fmu.name}: a part without a licence")
        require(names <= whole, f"{fmu.name}: not in the installation's: {sorted(names - whole)}")
        run_validator(text, fmu.name)
    print(f"{len(fmus)} FMUs and the installation; {'validated by spdx-tools too' if validated else 'spdx-tools is not installed'}")


if __name__ == "__main__":
    main()
