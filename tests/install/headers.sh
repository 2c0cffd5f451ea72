# SPDX-License-Identifier: Apache-2.0
# Tests that every installed header compiles alone, includes no third-party header and is installed once. Also tests
# that <mebots/run.hpp> includes only a few headers.
set -euo pipefail
include=$MEBOTS/include
count=0
while IFS= read -r header; do
  echo "#include <${header#"$include"/}>" >alone.cpp
  g++ -std=c++20 -Wall -Wextra -Wpedantic -Wshadow -Werror -fsyntax-only -H -I"$include" alone.cpp 2>opened.log \
    || { grep -v '^\.' opened.log; echo "FAILED: $header does not compile alone"; exit 1; }
  if grep -E '^\.+ .*/(nlohmann|fmt|Eigen|CLI|openssl)/|pugixml|hdf5|zip\.h' opened.log; then
    echo "FAILED: $header opens these"; exit 1
  fi
  count=$((count + 1))
done < <(find "$include" -name '*.hpp')
[[ $count -gt 0 ]]

# No header may be installed twice, because the compiler would treat the second copy as another file and read its
# declarations again.
twice=$( (cd "$include" && find . -name '*.hpp'; cd "$MEBOTS/share/mebots/fmu_soc/src" && find . -name '*.hpp') | sort | uniq -d)
[[ -z $twice ]] || { echo "FAILED: these are installed twice:"; echo "$twice"; exit 1; }

runners=$(find "$include/mebots" -maxdepth 1 -name '*.hpp' | wc -l)
((runners <= 11)) || { echo "FAILED: $runners headers for who runs systems"; exit 1; }

# Counts lines from MEbots' files in the preprocessor's output.
lines=$(echo '#include <mebots/run.hpp>' | g++ -std=c++20 -E -I"$include" -x c++ - |
  awk -v ours="$include/" '/^# [0-9]+ "/ { counts = index($0, ours) > 0; next } counts && NF { ++lines } END { print lines + 0 }')
((lines > 50 && lines <= 2000)) || { echo "FAILED: <mebots/run.hpp> brings $lines lines of ours"; exit 1; }
echo "ok: $count headers, $runners of them for who runs systems; <mebots/run.hpp> brings $lines lines beyond the standard library"
