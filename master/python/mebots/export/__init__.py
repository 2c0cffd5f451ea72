# SPDX-License-Identifier: Apache-2.0
"""Writes a run's results in other forms: ``mebots report --mcap`` and ``mebots report --video``."""
