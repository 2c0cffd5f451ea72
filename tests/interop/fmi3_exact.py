# SPDX-License-Identifier: Apache-2.0
"""Computes exact values of Reference FMUs from their equations, for fmi3_corpus.py.

- Dahlquist: x' = -k x.
- StateSpace: x' = A x + B u, y = C x + D u, with constant inputs.
- Roberts: Robertson's kinetics. Model exchange: SciPy's Radau with a relative tolerance of 1e-12.

In co-simulation, these FMUs use explicit Euler with a fixed step. For the linear FMUs, the exact result of this method is a power
of 1 - k h, or of I + h A.
"""

import numpy
import scipy.integrate
import scipy.linalg

EULER_STEP = {"Dahlquist": 0.1, "StateSpace": 1e-3, "Robertson Problem": 1e-6}  # FIXED_SOLVER_STEP in each FMU's config.h
EPSILON = 1e-5  # of cosimulation.c


def starts(model):
    """Returns the start values of Float64 variables as arrays."""
    found = {v.name: v for v in model.modelVariables if v.type == "Float64" and v.start is not None}
    return {name: numpy.array([float(text) for text in str(v.start).split()]).reshape(v.shape or ()) for name, v in found.items()}


def advanced(model, kind, matrix, times):
    """Returns the factors by which x' = matrix x multiplies the start state, one for each time."""
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


def robertson_rates(y1, y2):
    """Returns the derivatives of y1 and y2. The sum of y1, y2 and y3 is 1."""
    y3 = 1 - y1 - y2
    return -0.04 * y1 + 1e4 * y2 * y3, 0.04 * y1 - 1e4 * y2 * y3 - 3e7 * y2 * y2


def robertson(model, kind, times, _inputs):
    if kind == "model_exchange":
        solved = scipy.integrate.solve_ivp(lambda _t, y: robertson_rates(*y), (times[0], times[-1]), (1.0, 0.0), method="Radau", t_eval=times,
                                           rtol=1e-12, atol=1e-16)
        states = solved.y.T.tolist()
    else:
        step = EULER_STEP[model.modelName]
        states, (y1, y2), done = [], (1.0, 0.0), 0
        for k, t in enumerate(times):
            # Like the FMU, performs each step that ends at most EPSILON after the communication point.
            while k > 0 and (times[0] + done * step) + step - t <= EPSILON * max(t, 1.0):
                rate1, rate2 = robertson_rates(y1, y2)
                y1, y2, done = y1 + step * rate1, y2 + step * rate2, done + 1
            states.append((y1, y2))
    return {"y1": [y1 for y1, _ in states], "y2": [y2 for _, y2 in states], "y3": [1 - y1 - y2 for y1, y2 in states]}


EQUATIONS = {"Dahlquist": dahlquist, "StateSpace": state_space, "Robertson Problem": robertson}


def exact_columns(model, kind, times, inputs):
    """Returns the exact outputs of a Reference FMU. For any other FMU, returns None."""
    solve = EQUATIONS.get(model.modelName) if "Reference FMUs" in (model.generationTool or "") else None
    return solve(model, kind, times, inputs) if solve else None
