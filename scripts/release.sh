#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the checklist before a release. Runs every proof, even after a failure, and prints a table. The output of each
# proof is in build/release-check. The exit code is 1 if a proof failed. A proof that cannot run here is skipped; the
# table contains the reason. A proof that passed but omitted tests counts as skipped, unless may_be_left_out permits
# these omissions. Without --dry-run, no proof may be skipped. If all proofs have passed, tags the version. Pushing the
# tag is up to you.
#
#   scripts/release.sh --dry-run [PROOF...]    all proofs, or these
#   MEBOTS_CORPUS=FOLDER        checkouts with FMUs of others, for the proof `corpus` (docs/interop.md names them)
#   MEBOTS_CONFORMANCE=FOLDER   checkouts of the suites, for the proof `conformance` (scripts/conformance.sh names them)
#   MEBOTS_MAINTAINER='NAME <ADDRESS>'  maintainer of the Debian package
#   MEBOTS_FUZZ_SECONDS=N       for each target, 120 by default
set -uo pipefail
cd "$(dirname "$0")/.."

version=$(sed -nE 's/^project\(mebots VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)
proofs=(clean changelog maintainer tests long demo bits leaks sanitizers fuzz corpus conformance arm64 wheel debian docs)

skip() { echo "skipped: $*"; return 77; }
need() {  # need PROGRAM...: skips the proof if one is missing
  local program
  for program; do command -v "$program" >/dev/null || { skip "$program is not installed"; return; }; done
}
need_root() { ((EUID == 0)) || skip "needs root: it installs into a separate Debian"; }

clean() { [[ -z $(git status --porcelain) ]] || { git status --short; echo "the working tree differs from the last commit"; return 1; }; }
changelog() {
  grep -qF "## [$version]" CHANGELOG.md || { echo "CHANGELOG.md has no heading '## [$version]'"; return 1; }
  ! grep -qF '## [Unreleased]' CHANGELOG.md || { echo "CHANGELOG.md still has changes under '## [Unreleased]'"; return 1; }
}
maintainer() { [[ -n ${MEBOTS_MAINTAINER:-} ]] || skip "MEBOTS_MAINTAINER is not set: the Debian package would have no maintainer"; }
tests() { scripts/test.sh && scripts/lint.py build/ci; }
long() { cmake --preset ci && cmake --build --preset ci && ctest --preset long -j "$(nproc)"; }
demo() { scripts/demo.sh; }
bits() {
  built && need qemu-x86_64 && cmake --preset dev &&
    cmake --build --preset dev --target mebots fmu_{soc,world,battery,motors}_archive &&
    scripts/same_results.sh build/release build/dev && scripts/same_bytes.sh build/release
}
leaks() { cmake --preset ci && cmake --build --preset ci && scripts/scale.sh build/ci; }
sanitizers() { scripts/sanitize.sh; }
fuzz() {
  local target
  need clang++-14 || return
  for target in $(sed -nE 's/^ *mebots_fuzz\(([a-z0-9_]+).*/\1/p' tests/fuzz/CMakeLists.txt); do
    scripts/fuzz.sh "$target" 1000000000 "-max_total_time=${MEBOTS_FUZZ_SECONDS:-120}" || return 1
  done
}
corpus() { [[ -n ${MEBOTS_CORPUS:-} ]] || { skip "MEBOTS_CORPUS does not name a folder with FMUs"; return; }; built && scripts/corpus.sh "$MEBOTS_CORPUS"; }
conformance() {
  [[ -n ${MEBOTS_CONFORMANCE:-} ]] || { skip "MEBOTS_CONFORMANCE does not name a folder with the suites"; return; }
  built && scripts/conformance.sh "$MEBOTS_CONFORMANCE"
}
arm64() { need aarch64-linux-gnu-g++ qemu-aarch64-static mmdebstrap && built && scripts/arm64.sh; }
wheel() { need_root && need debootstrap && scripts/wheel.sh && scripts/try_package.sh build/wheels/mebots-*.whl; }
debian() { need_root && need debootstrap && scripts/package.sh; }
docs() { scripts/docs.sh; }
built() { scripts/setup.sh && cmake --preset release && cmake --build --preset release; }  # always, because an existing build may be of
                                                                                           # another commit

# True if the proof (a row of this script's table) stays complete when ctest skips the test.
may_be_left_out() {  # may_be_left_out PROOF TEST
  case $1:$2 in
    *:Interop.*OMSimulator*) ;;  # OMSimulator has to be built from source
    sanitizers:*) ;;             # the sanitizer handles crashes and allocations; the proof `tests` reports missing tools
    *) return 1 ;;
  esac
}

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
failed=0 skipped=0 table=
for name in "${chosen[@]}"; do
  echo "== $name"
  SECONDS=0
  "$name" >"$logs/$name.txt" 2>&1
  case $? in
    0) result=passed remark= ;;
    77) result=skipped remark=$(sed -n 's/^skipped: //p' "$logs/$name.txt" | tail -n 1) skipped=$((skipped + 1)) ;;
    *) result=FAILED remark=$(tail -n 1 "$logs/$name.txt") failed=$((failed + 1)); tail -n 5 "$logs/$name.txt" ;;
  esac
  # Lists the tests that ctest skipped. The proof then counts as skipped, unless may_be_left_out permits it.
  left_out=
  while IFS= read -r test; do
    left_out+="${left_out:+, }$test"
    if [[ $result == passed ]] && ! may_be_left_out "$name" "$test"; then result=skipped skipped=$((skipped + 1)); fi
  done < <(sed -nE 's/^[[:space:]]*[0-9]+ - (.+) \(Skipped\).*/\1/p' "$logs/$name.txt" | sort -u)
  if [[ -n $left_out ]]; then remark+="${remark:+; }left out: $left_out"; fi
  table+=$(printf '| %-11s | %-7s | %4d s | %s |' "$name" "$result" "$SECONDS" "${remark//|/\/}")$'\n'
done
printf '\nMEbots %s at %s; output in %s\n\n| proof       | result  | time   | remark |\n|---|---|---|---|\n%s\n' \
  "$version" "$(git describe --always --dirty)" "$logs" "$table"
echo "$((${#chosen[@]} - failed - skipped)) of ${#chosen[@]} proofs passed, $failed failed, $skipped skipped"
if ((failed)); then exit 1; fi
if [[ -n $dry ]]; then exit 0; fi
if ((skipped)); then
  echo "release.sh: not tagged: a release skips nothing" >&2
  exit 1
fi
git tag -a "v$version" -m "MEbots $version"
echo "tagged v$version; next: git push origin v$version"
