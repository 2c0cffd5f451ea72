# SPDX-License-Identifier: Apache-2.0
"""Recorded flights. Contains readers of logs, ``mebots replay``, ``mebots identify`` and ``mebots new-cell``.

    log      a log in memory: named signals, each with its unit and times
    usd      reader of the Crazyflie's binary logs
    tables   reader of CSV files
    ulog     reader of PX4's ULog
    names    maps columns of a log to signals
    reading  reads any kind of log file
    quality  rules that find and exclude bad samples
    airframe airframe files and their data files
    traces   runs the FMUs with a log's commands
    inverse  computes commands for a log that has none
    motion   the vertical forces that the measured motion requires
    compare  errors of the models: computed minus measured values
    replay   ``mebots replay``; ``replay_page`` is its page
    fitting  fits parameters by least squares, with intervals
    cell_fit fits a cell to voltages of flights
    identify ``mebots identify``
    new_cell ``mebots new-cell``
    command  the command lines of the three commands
"""
