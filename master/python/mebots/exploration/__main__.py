# SPDX-License-Identifier: Apache-2.0
"""``python -m mebots.exploration STUDY --out DIR`` runs a study like ``mebots sweep``."""

import sys

from mebots.exploration.command import main

sys.exit(main())
