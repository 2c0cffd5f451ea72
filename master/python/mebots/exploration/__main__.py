# SPDX-License-Identifier: Apache-2.0
"""Runs a study as ``mebots sweep`` does: ``python -m mebots.exploration STUDY --out DIR``."""

import sys

from mebots.exploration.command import main

sys.exit(main())
