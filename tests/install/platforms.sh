# SPDX-License-Identifier: Apache-2.0
# Tests an FMU with sources and binaries for several platforms. It must give the same bits on Linux, under wine, and
# from a library that FMPy compiles from the sources. Fetches musl's sources.
set -euo pipefail
cp "$NEEDED/descriptions/motor_thermal.json" .
mebots new-fmu motor_thermal.json --out own
configure() { cmake -S own -B "$1" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" "${@:2}"; }

refused() {  # EXPECTED OPTION..., in a message that CMake breaks into lines
  if configure refused "${@:2}" >refused.log 2>&1; then echo "FAILED: ${*:2} is accepted"; exit 1; fi
  grep -q -- "$1" <<<"$(tr -s '\n ' ' ' <refused.log)" || { cat refused.log; exit 1; }
}
refused "use linux64, win64 or aarch64-linux" "-DMEBOTS_PLATFORMS=linux64;win46"
refused "apt-get install g++-mingw-w64-x86-64-posix" -DMEBOTS_PLATFORMS=win64 -D_mebots_compiler=
refused "expected 7d5b0b60" -DMEBOTS_FMU_SOURCES=ON -DMEBOTS_MUSL_SOURCE="$PWD/motor_thermal.json"

platforms="linux64"
for pair in win64:x86_64-w64-mingw32-g++-posix aarch64-linux:aarch64-linux-gnu-g++; do
  if command -v "${pair#*:}" >/dev/null; then platforms+=";${pair%%:*}"; fi
done
configure build "-DMEBOTS_PLATFORMS=$platforms" -DMEBOTS_FMU_SOURCES=ON >configure.log || { cat configure.log; exit 1; }
cmake --build build >build.log 2>&1 || { cat build.log; exit 1; }

cat >inputs.py <<'P'
import xml.etree.ElementTree, sys, zipfile
root = xml.etree.ElementTree.fromstring(zipfile.ZipFile(sys.argv[1]).read("modelDescription.xml"))
reals = [(v, v if v.tag == "Float64" else v.find("Real")) for v in root.iter() if v.get("causality") == "input"]
inputs = [(v.get("name"), float(real.get("min", 0))) for v, real in reals if real is not None]
print(",".join(["time", *(name for name, _ in inputs)]))
for row in range(11):
    print(",".join(str(x) for x in [row / 10, *(low + 0.25 + 0.1 * ((row * 7 + i * 3) % 5) for i, (_, low) in enumerate(inputs))]))
P
run() {  # FMU OUT
  mebots run "$1" --inputs inputs.csv --step 0.01 --stop-time 1 --quiet --out "$2" 2>"$2.log" || { cat "$2.log"; exit 1; }
  [[ $(cut -d, -f2- "$2/results.csv" | sort -u | wc -l) -gt 10 ]] || { echo "FAILED: the outputs of $1 stay constant"; exit 1; }
}
same() { cmp <(tail -n +2 "$1/results.csv") <(tail -n +2 "$2/results.csv"); }  # the first line names the archive

for fmu in motor_thermal motor_thermal_fmi3; do
  archive=build/fmus/$fmu.fmu
  mebots check "$archive" >check.log || { cat check.log; exit 1; }
  [[ $(grep -c 'binaries/' check.log) == $(tr ';' '\n' <<<"$platforms" | wc -l) ]] || { cat check.log; exit 1; }
  "$PYTHON" inputs.py "$archive" >inputs.csv
  run "$archive" "linux_$fmu"

  # FMPy reads the language C++20 from buildDescription.xml. FMI 2.0 has no such file, so CXXFLAGS selects the language.
  CXXFLAGS="-std=gnu++20 -ffp-contract=off -fno-builtin" "$PYTHON" - "$archive" compiled.fmu >fmpy.log 2>&1 <<'P' || { tail -n 40 fmpy.log; exit 1; }
import os, shutil, sys, zipfile
from fmpy.build import build_platform_binary
with zipfile.ZipFile(sys.argv[1]) as packed:
    packed.extractall("unpacked")
shutil.rmtree("unpacked/binaries")
build_platform_binary(os.path.abspath("unpacked"))
shutil.make_archive("compiled", "zip", "unpacked")
shutil.move("compiled.zip", sys.argv[2])
shutil.rmtree("unpacked")
P
  run compiled.fmu "compiled_$fmu"
  same "linux_$fmu" "compiled_$fmu"

  if [[ $platforms == *win64* && -e $MEBOTS/bin/mebots-windows-host.exe && -n $(command -v wine64 || ls /usr/lib/wine/wine64 2>/dev/null) ]]; then
    "$PYTHON" -c 'import sys, zipfile
with zipfile.ZipFile(sys.argv[1]) as one, zipfile.ZipFile("windows.fmu", "w") as two:
    for name in one.namelist():
        if not name.startswith("binaries/") or "win" in name:
            two.writestr(name, one.read(name))' "$archive"
    run windows.fmu "windows_$fmu"
    same "linux_$fmu" "windows_$fmu"
    echo "ok: $fmu has the same bits under wine"
  fi
done
echo "ok: $platforms, and the same bits from the sources"
