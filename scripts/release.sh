#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The checklist before a release. Runs every proof, goes on after one that fails, and prints a table; each proof's output is kept in
# build/release-check. Without --dry-run, when all have passed, the version is tagged; pushing the tag is left to you.
#
#   scripts/release.sh --dry-run [PROOF...]    all proofs, or these
#   MEBOTS_CORPUS=FOLDER        checkouts with FMUs of others, for the proof `corpus`
#   MEBOTS_CONFORMANCE=FOLDER   checkouts of the suites, for the proof `conformance`
set -uo pipefail
cd "$(dirname "$0")/.."

version=$(sed -nE 's/^project\(mebots VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)
proofs=(clean changelog tests demo sanitizers fuzz corpus conformance arm64 wheel debian docs)

clean() { git diff --quiet HEAD && [[ -z $(git status --porcelain) ]] || { git status --short; echo "the working tree differs from the last commit"; return 1; }; }
changelog() { grep -qF "## [$version]" CHANGELOG.md || { echo "CHANGELOG.md has no heading '## [$version]'"; return 1; }; }
tests() { scripts/test.sh; }
demo() { scripts/demo.sh; }
sanitizers() { scripts/sanitize.sh; }
fuzz() {
  local target
  for target in $(sed -nE 's/^mebots_fuzz\(([a-z_]+).*/\1/p' tests/fuzz/CMakeLists.txt); do
    scripts/fuzz.sh "$target" 1000000000 -max_total_time=120 || return 1
  done
}
corpus() { scripts/corpus.sh "${MEBOTS_CORPUS:?name the folder with others\' FMUs}"; }
conformance() { scripts/conformance.sh "${MEBOTS_CONFORMANCE:?name the folder with the suites}"; }
arm64() { scripts/arm64.sh; }
wheel() { scripts/wheel.sh && scripts/try_package.sh build/wheels/mebots-*.whl; }
debian() { scripts/package.sh; }
docs() { scripts/docs.sh; }

dry=
if [[ ${1:-} == --dry-run ]]; then
  dry=yes
  shift
fi
chosen=("$@")
if [[ ${#chosen[@]} -eq 0 ]]; then chosen=("${proofs[@]}"); fi
for name in "${chosen[@]}"; do
  [[ " ${proofs[*]} " == *" $name "* ]] || { echo "release.sh: there is no proof '$name'; known: ${proofs[*]}" >&2; exit 2; }
done
if [[ -z $dry && ${#chosen[@]} -ne ${#proofs[@]} ]]; then
  echo "release.sh: a release needs all proofs; --dry-run runs some" >&2
  exit 2
fi

logs=build/release-check
mkdir -p "$logs"
failed=0
table=
for name in "${chosen[@]}"; do
  echo "== $name"
  SECONDS=0
  if "$name" >"$logs/$name.txt" 2>&1; then
    result=passed
  else
    result=FAILED
    failed=$((failed + 1))
    tail -n 5 "$logs/$name.txt"
  fi
  table+=$(printf '| %-11s | %-6s | %4d s | %s |' "$name" "$result" "$SECONDS" "$logs/$name.txt")$'\n'
done
printf '\nMEbots %s at %s\n\n| proof       | result | time   | output |\n|---|---|---|---|\n%s' "$version" "$(git describe --always --dirty)" "$table"
if ((failed)); then
  echo "$failed of ${#chosen[@]} proofs failed"
  exit 1
fi
if [[ -z $dry ]]; then
  git tag -a "v$version" -m "MEbots $version"
  echo "tagged v$version; next: git push origin v$version"
fi
