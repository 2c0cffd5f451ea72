#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests that the shipped missions start without notices, because each input has a source or a value in the config. Also
# tests that a take-off logs no warning: one line at the end of the flight reports the time above the cell's continuous
# current. Usage: no_notices.sh MEBOTS CONFIGS
set -euo pipefail
mebots=$1 configs=$2 count=0
for config in "$configs"/*.json; do
  case $(basename "$config") in dronet.json | link.json | link_4.json) continue ;; esac  # the program is the reader's; a script sets the inputs
  said=$("$mebots" run "$config" --dry-run 2>&1) || { echo "FAILED: $config: $said"; exit 1; }
  if grep "^notice" <<<"$said"; then echo "FAILED: $config"; exit 1; fi
  count=$((count + 1))
done
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
said=$("$mebots" run "$configs/gate_easy.json" --stop-time 6 --out "$out/flight" 2>&1) || { echo "FAILED: $said"; exit 1; }
if grep "warning" <<<"$said"; then echo "FAILED: gate_easy"; exit 1; fi
[[ $(grep -c "above the cell's continuous limit of 3 A for" <<<"$said") == 1 ]] || { echo "FAILED: $said"; exit 1; }
echo "ok: $count missions"
[[ $count -ge 9 ]]
