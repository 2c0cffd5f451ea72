# SPDX-License-Identifier: Apache-2.0
"""Exports a run's results in other formats, for ``mebots report --mcap`` and ``mebots report --video``."""
