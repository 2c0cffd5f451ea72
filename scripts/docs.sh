#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the site in build/docs/html: Sphinx for docs/ and the READMEs, Doxygen for C++, and a notebook that runs a
# mission. The exit code is 1 after a warning or a broken link. Installs the tools that only the site needs: Debian's
# doxygen, and Sphinx in a separate virtual environment.
#
#   scripts/docs.sh [BUILD]    BUILD: a build with the programs and FMUs that the pages describe; default build/release, built if necessary
set -euo pipefail
cd "$(dirname "$0")/.."

build=${1:-build/release}
if [[ $# -eq 0 ]]; then
  scripts/setup.sh
  cmake --preset release
  cmake --build --preset release
fi

if ! command -v doxygen >/dev/null; then
  sudo=()
  if [[ $EUID -ne 0 ]]; then sudo=(sudo); fi
  "${sudo[@]}" apt-get update -qq
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends doxygen
fi
environment=build/docs-environment
requirements=scripts/requirements-docs.txt
if ! cmp -s "$requirements" "$environment/${requirements##*/}"; then
  /usr/bin/python3 -m venv "$environment"
  "$environment/bin/python" -m pip install --quiet --disable-pip-version-check -r "$requirements"
  cp "$requirements" "$environment/"
fi

mkdir -p build/docs
doxygen docs/site/Doxyfile
sed -i '/<derivedcompoundref/d' build/docs/doxygen/xml/*.xml  # breathe refers to labels that it does not create; bases are shown

# The notebook uses programs and Python package of this build.
export MEBOTS_DOCS_BUILD=$PWD/$build MEBOTS_DOCS_XML=$PWD/build/docs/doxygen/xml
export PATH=$MEBOTS_DOCS_BUILD/bin:$PATH PYTHONPATH=$MEBOTS_DOCS_BUILD/python
"$environment/bin/python" -m sphinx -b html -E -n -W --keep-going -j 2 -q -c docs/site -d build/docs/doctrees . build/docs/html
echo "site: $PWD/build/docs/html/index.html ($(find build/docs/html -name '*.html' | wc -l) pages)"
