# SPDX-License-Identifier: Apache-2.0
# Tests the package of the installation: missions that use its FMUs, and instances in separate processes.
set -euo pipefail
export PYTHONPATH=$(dirname "$(dirname "$(find "$MEBOTS/lib" -name '_mebots*.so')")") PYTHONDONTWRITEBYTECODE=1
unset MEBOTS_FMU_PATH
PATH=${PATH#*:} "$PYTHON" "$NEEDED/python_test.py" "$MEBOTS/share/mebots/fmus"
cp "$MEBOTS/share/mebots/configs/battery_motors.json" .
PATH=${PATH#*:} "$PYTHON" -c "
import mebots
mission = mebots.Mission('battery_motors.json')
mission.run()
assert mission.outcome == 'completed', mission.outcome
"
