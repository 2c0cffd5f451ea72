#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs both experiments of the paper on all cores, and writes results/paper/report.html. Passes options to
# study/study.py: --parts experiments landing clocks shipped easy hard, --chip BOARD, --count N, --jobs N, --build DIR,
# --out DIR.
set -euo pipefail
cd "$(dirname "$0")/../.."

python=.venv/bin/python
[ -x "$python" ] || { echo "run scripts/setup.sh first" >&2; exit 2; }
case " $* " in
  *" --build"*) ;;
  *) cmake --preset release >/dev/null && cmake --build --preset release ;;
esac
exec "$python" examples/paper/study/study.py "$@"
