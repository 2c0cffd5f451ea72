# SPDX-License-Identifier: Apache-2.0
# Tests that no file of the installation contains paths of sources or build: texts, programs, libraries, and the files
# in FMUs. Therefore the FMUs have the same bytes from any folder (scripts/same_bytes.sh builds them in two folders).
# Also rejects paths relative to the build folder, because a compiler cache may put them in place of absolute paths.
set -euo pipefail
mkdir unpacked
for fmu in "$MEBOTS"/share/mebots/fmus/*.fmu; do
  (mkdir "unpacked/$(basename "$fmu")" && cd "unpacked/$(basename "$fmu")" && cmake -E tar xf "$fmu")
done
found=$(grep -raoE "($SOURCES|$BUILD)/[^[:cntrl:] \"']*" "$MEBOTS" unpacked | sort -u | head -20 || true)
[[ -z $found ]] || { echo "FAILED: these name $SOURCES or $BUILD:"; echo "$found"; exit 1; }
found=$(grep -raoE "(modeldesc|fmu_[a-z]+|master)/(src|include|shell|data)/[A-Za-z0-9_/]*\.[ch]pp" unpacked/*/binaries | sort -u | head -20 || true)
[[ -z $found ]] || { echo "FAILED: these FMUs name files by their way from the build folder:"; echo "$found"; exit 1; }
echo "ok: $(find "$MEBOTS" -type f | wc -l) files, none names $SOURCES or $BUILD"
