#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests that the shipped missions begin without notices, because each input has a source or a value in the config. Usage: no_notices.sh MEBOTS CONFIGS
set -euo pipefail
mebots=$1 configs=$2 count=0
for config in "$configs"/*.json; do
  case $(basename "$config") in dronet.json | link.json) continue ;; esac  # the program is the reader's; a script sets the inputs
  said=$("$mebots" run "$config" --dry-run 2>&1) || { echo "FAILED: $config: $said"; exit 1; }
  if grep "^notice" <<<"$said"; then echo "FAILED: $config"; exit 1; fi
  count=$((count + 1))
done
echo "ok: $count missions"
[[ $count -ge 9 ]]
