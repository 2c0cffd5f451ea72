# SPDX-License-Identifier: Apache-2.0
"""Exact values of Reference FMUs whose equations can be solved in closed form, for fmi3_corpus.py.

- Dahlquist: x' = -k x.
- StateSpace: x' = A x + B u, y = C x + D u, with constant inputs.

In co-simulation these FMUs use explicit Euler with a fixed step. Its exact result is a power of 1 - k h, or of I + h A.
"""

import numpy
import scipy.linalg

EULER_STEP = {"Dahlquist": 0.1, "StateSpace": 1e-3}  # FIXED_SOLVER_STEP in each FMU's config.h


def starts(model):
    """Returns the start values of Float64 variables as arrays."""
    found = {v.name: v for v in model.modelVariables if v.type == "Float64" and v.start is not None}
    return {name: numpy.array([float(text) for text in str(v.start).split()]).reshape(v.shape or ()) for name, v in found.items()}


def advanced(model, kind, matrix, times):
    """Returns the factor by which x' = matrix x multiplies the state from the start to each time."""
    if kind == "model_exchange":
        return [scipy.linalg.expm(matrix * (t - times[0])) for t in times]
    step = EULER_STEP[model.modelName]
    euler = numpy.eye(len(matrix)) + step * matrix
    return [numpy.linalg.matrix_power(euler, round((t - times[0]) / step)) for t in times]


def dahlquist(model, kind, times, _inputs):
    start = starts(model)
    factors = advanced(model, kind, numpy.array([[-float(start["k"])]]), times)
    return {"x": [float(factor[0, 0] * start["x"]) for factor in factors]}


def state_space(model, kind, times, inputs):
    start = starts(model)
    a, b, c, d = (start[name] for name in "ABCD")
    u = numpy.array([inputs[f"u[{k + 1}]"] for k in range(b.shape[1])])
    n = len(a)
    whole = numpy.zeros((n + 1, n + 1))  # the last state is 1, and carries B u
    whole[:n, :n], whole[:n, n] = a, b @ u
    begin = numpy.append(start["x0"], 1)
    outputs = [c @ (factor @ begin)[:n] + d @ u for factor in advanced(model, kind, whole, times)]
    return {f"y[{k + 1}]": [float(y[k]) for y in outputs] for k in range(len(c))}


EQUATIONS = {"Dahlquist": dahlquist, "StateSpace": state_space}


def exact_columns(model, kind, times, inputs):
    """Returns the exact outputs of a Reference FMU; None for other FMUs."""
    solve = EQUATIONS.get(model.modelName) if "Reference FMUs" in (model.generationTool or "") else None
    return solve(model, kind, times, inputs) if solve else None
