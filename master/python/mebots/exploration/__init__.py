# SPDX-License-Identifier: Apache-2.0
"""Answers a question by many missions: ``mebots.sweep``, and ``mebots sweep`` on the command line.

    study -> designs x draws -> missions (hash of all inputs) -> workers -> journal -> answers with confidence -> report

A mission never knows that it is part of a study. Each module has one subject:

=============  =========================================================================
``study``      the study file, checked by the reader in C++
``chance``     draws: a function of seed, name and index alone
``designs``    which designs there are, by kind
``space``      designs, draws and the order of each mission
``missions``   a mission as an order for a worker, and the hash of all it depends on
``orders``     orders of many missions as columns, and batches of them
``replies``    results of a batch: lines for the journal, and columns for the tables
``pasts``      states that missions begin with, which others left
``worker``     flies orders in a process of its own
``flying``     such a process from outside: its limits, crashes and hangs; ``fly_all`` for executors
``outcomes``   tells a mission's outcome from a full disk, too little memory or a killed process
``dispatch``   gives batches of orders to an executor, takes results back and counts attempts
``journal``    results on disk, with checksums
``files``      files that are complete or absent
``results``    what is known of each mission, and its row of missions.csv
``objectives`` from a mission's values to the numbers that the study asks for
``answers``    intervals and confidence sequences
``answer``     headline and ranked table
``figures``    numbers with units, as people read them
``progress``   how far a study is
``live_page``  live.html of a study that is under way
``rounds``     what is flown next, and which designs need no more
``search``     the same for designs that Optuna asks for
``splitting``  the probability of rare events, level by level
``sensitivity`` which factors matter (SALib)
``pareto``     points that no other one dominates
``front``      which designs are dominated, and how sure that is
``tables``     missions.csv, designs.csv
``columns``    the same as HDF5 and Parquet
``report``     the content of report.html of a study that compares designs; ``rare_report`` of a rare event's
``report_missions`` its missions and the commands that fly them again; ``report_page`` writes the page of ``web/src/report``
``effects``    main effects, interactions and importances of factors
``extras``     packages of the extra mebots[sweep]
``campaign``   all of it in order
``sweep``      the result: data frames, answer and page
``command``    the command line
=============  =========================================================================
"""
