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
``inputs``     hashes of files and folders that missions name
``orders``     orders of many missions as columns, and batches of them
``replies``    results of a batch: lines for the journal, and columns for the tables
``pasts``      saved states from which missions start
``worker``     executes orders in a separate process
``flying``     controls a worker process: its limits, crashes and hangs; executors call its ``fly_all``
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
``rounds``     chooses the next missions, and ends designs that need no more
``search``     chooses the next designs with Optuna
``splitting``  the probability of rare events, level by level
``sensitivity`` the influence of factors (SALib)
``pareto``     points that no other point dominates
``front``      which designs are certainly on the Pareto front, and which are certainly dominated
``tables``     missions.csv, designs.csv
``columns``    the same tables as HDF5 and Parquet
``report``     the content of report.html for a study that compares designs; ``rare_report`` for a rare event
``report_missions`` missions in the report, and the commands that repeat them; ``report_page`` writes the page
``effects``    main effects, interactions and importances of factors
``extras``     packages of the extra mebots[sweep]
``campaign``   runs a study from start to end
``sweep``      the result of a study: data frames, answer and page
``command``    the command line
=============  =========================================================================
"""
