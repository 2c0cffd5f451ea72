# SPDX-License-Identifier: Apache-2.0
"""``mebots deploy``: converts a network in ONNX to firmware for the chip, which computes with integers.

    deploying     runs the whole deployment; ``command`` is its command line
    lowering      converts a model to a deployed network in memory: all steps from ``model_file`` to ``plan``
    deployed      options of a deployment, and the deployed network
    model_file    reads and checks the ONNX file, infers shapes, computes constants
    importer      converts ONNX nodes to a float network (``graph``), with one function per operator
    context       data and helpers of these functions; ``moving`` and ``transposed`` contain further ones
    functions     functions of single values, such as Sigmoid, which the chip evaluates by a table
    simplify      merges nodes
    pictures      reads inputs
    calibrate     runs the float network in onnxruntime, and collects the ranges of its tensors
    equalise      cross-layer equalisation
    arithmetic    scales of bytes, and the integers that convert a sum to a byte
    quantise      converts the float network to integers
    integer_nodes reads networks that already have integer weights; ``integer_layers`` creates their layers
    layers        the layers of the integer network, and their reference in NumPy
    plan          places tensors in memory, and divides layers into steps; ``roofline`` computes lower bounds of their cycles
    emit          writes the network as C; ``c_files`` contains the texts of the files
    chip          builds the C code for this machine and for the chip, and runs it
    checking      compares the C code with the reference
    measure       measures time and energy of each layer on the chip
    contracts     inputs and outputs that the firmware of a flight requires
    judging       determines the accuracy, also for other input sizes; ``labels``, ``accuracy`` and ``sizes`` are its parts
    report        writes network.json and the table on the terminal; ``network_page`` writes the page
"""
