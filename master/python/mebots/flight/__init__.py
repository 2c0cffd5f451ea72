# SPDX-License-Identifier: Apache-2.0
"""Recorded flights: readers of logs, ``mebots replay``, ``mebots identify`` and ``mebots new-cell``.

    log      the type in memory: named signals, each with its unit and its own times
    usd      reader of the Crazyflie's binary logs
    tables   reader of CSV files
    ulog     reader of PX4's ULog
    names    which column of a log is which signal
    reading  one function for all kinds of files
    quality  rules that find and exclude bad samples
"""
