# SPDX-License-Identifier: Apache-2.0
"""Answers questions by running many missions. Implements ``mebots.sweep``, and ``mebots sweep`` on the command line.

    study -> designs x draws -> missions (hash of all inputs) -> workers -> journal -> answers with confidence -> report

The result of a mission does not depend on the study that contains it. Each module has one subject:

=============  =========================================================================
``study``      the study file, checked by the reader in C++
``chance``     draws: a function of seed, name and index
``designs``    the designs of each kind
``space``      designs, draws and the order of each mission
``missions``   a mission as an order for a worker, and the hash of its inputs
``inputs``     files and folders that missions name, by their hashes
``orders``     orders of many missions as columns, and batches of them
``replies``    results of a batch: lines for the journal, and columns for the tables
``pasts``      saved states from which missions start
``worker``     executes orders in a separate process
``flying``     controls such a process: its limits, crashes and hangs; ``fly_all`` for executors
``outcomes``   distinguishes a mission's outcome from a full disk, too little memory or a killed process
``dispatch``   passes batches of orders to an executor, collects results and counts attempts
``journal``    results on disk, with checksums
``files``      files that are complete or absent
``results``    the state of each mission, and its row of missions.csv
``objectives`` converts a mission's values to the numbers that the study requests
``answers``    intervals and confidence sequences
``answer``     headline and ranked table
``figures``    numbers with units for people
``progress``   the progress of a study
``live_page``  live.html of a running study
``rounds``     the next missions, and the designs that need no more
``search``     the next missions of designs that Optuna proposes
``splitting``  the probability of rare events, level by level
``sensitivity`` the influence of factors (SALib)
``pareto``     points that no other point dominates
``front``      dominated designs, and how certain that is
``tables``     missions.csv, designs.csv
``columns``    the same as HDF5 and Parquet
``report``     the content of report.html for a study that compares designs; ``rare_report`` for a rare event
``report_missions`` its missions and the commands that repeat them; ``report_page`` writes the page of ``web/src/report``
``effects``    main effects, interactions and importances of factors
``extras``     packages of the extra mebots[sweep]
``campaign``   runs a study from start to end
``sweep``      the result: data frames, answer and page
``command``    the command line
=============  =========================================================================
"""
