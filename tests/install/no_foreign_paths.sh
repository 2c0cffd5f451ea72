# SPDX-License-Identifier: Apache-2.0
# No file of the installation knows where sources or build were: texts, programs, libraries, and what is in the FMUs. Where
# assertions are on, they name their source files; nobody opens these.
set -euo pipefail
mkdir unpacked
for fmu in "$MEBOTS"/share/mebots/fmus/*.fmu; do
  (mkdir "unpacked/$(basename "$fmu")" && cd "unpacked/$(basename "$fmu")" && cmake -E tar xf "$fmu")
done
found=$(grep -raoE "($SOURCES|$BUILD)/[^[:cntrl:] \"']*" "$MEBOTS" unpacked | grep -vE '\.[ch]pp$' | sort -u | head -20 || true)
[[ -z $found ]] || { echo "FAILED: these name $SOURCES or $BUILD:"; echo "$found"; exit 1; }
echo "ok: $(find "$MEBOTS" -type f | wc -l) files, none names $SOURCES or $BUILD"
