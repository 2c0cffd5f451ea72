# SPDX-License-Identifier: Apache-2.0
"""Recorded flights: readers of logs, ``mebots replay``, ``mebots identify`` and ``mebots new-cell``.

    log      the type in memory: named signals, each with its unit and its own times
    usd      reader of the Crazyflie's binary logs
    tables   reader of CSV files
    ulog     reader of PX4's ULog
    names    which column of a log is which signal
    reading  one function for all kinds of files
    quality  rules that find and exclude bad samples
    airframe airframe files, and the data files that they name
    traces   a log's commands on the real FMUs
    inverse  commands for a log that has none
    motion   the vertical momentum balance
    compare  errors of the model
    replay   ``mebots replay``; ``replay_page`` is its page
    fitting  least squares, with intervals
    cell_fit a cell from voltages of flights
    identify ``mebots identify``
    new_cell ``mebots new-cell``
    command  the three commands
"""
