# SPDX-License-Identifier: Apache-2.0
"""``mebots deploy``: a network in ONNX becomes firmware for the chip, in integers.

    model_file  the ONNX file: checked, shapes, constants
    importer    operators of ONNX to a graph in float (graph); functions, moving and transposed convert operators of
                their kinds, context has what they need
    simplify    merges nodes
    pictures    inputs for calibration
    calibrate   the model in onnxruntime, and the ranges of its tensors
    arithmetic  scales, and how a sum becomes a byte
    equalise    cross-layer equalisation
    quantise    the network in integers; integer_nodes and integer_layers for networks of whole numbers
    layers      its layers, and the reference of each in numpy
    plan        memories and tiles
    emit        the network as C; c_files has the texts of its files
    chip        builds and runs it; checking compares it with the reference; measure has its cost by layer
    contracts   what a flight's firmware needs of a network
    report      network.json and the table; network_page draws it
    deployed    options, and the network in memory
    lowering    the steps above
    labels, accuracy, sizes, judging   compare with float and labels, for several sizes of the input
    deploying   the whole deployment; command is the command line
"""
