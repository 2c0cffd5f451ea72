# SPDX-License-Identifier: Apache-2.0
"""Computes known solutions for FMUs of other tools, without another master (scripts/corpus.sh).

A truth is an analytic solution, a numerical solution of the model's equations to 1e-10, or a reference file next to the FMU. The
equations come from the documentation of the Modelica Standard Library, of the Reference FMUs, and of the FMUs' repositories.
Parameters come from the FMU's own description. Inputs are constant. The bound is the permitted deviation of an FMU from the
truth. If the FMU's method is exact, the bound is that of rounding. Otherwise, it is the error of the documented method with the
same step.
"""

import csv
import dataclasses
import math
import pathlib
import re
from typing import Callable

import numpy as np
import scipy.integrate
import scipy.linalg

ROUNDING = 1e-9     # relative to the largest value: sums of some thousand steps
USEFUL = 0.25       # of the largest value: a larger bound decides nothing
BOUND_OF_METHOD = 1.5  # of the error of the documented method, whose variants differ in the last stage or event


@dataclasses.dataclass
class Truth:
    kind: str                 # "analytic", "equations" or "reference file"
    source: str               # where it is from
    values: Callable          # times [s] -> {variable: values}
    inputs: dict = dataclasses.field(default_factory=dict)
    bound: Callable = None    # times, step [s] -> {variable: largest error}; None: rounding
    bound_text: str = "rounding"
    jumps: Callable = None    # times -> True at a jump, where the value may be that before or after it
    step: float = None        # communication step [s], if that of the default experiment is too long for the FMU's method
    steps: int = None


class Model:
    """Variables of a description read by FMPy, by name."""

    def __init__(self, description):
        self.description = description
        self.name = description.modelName
        self.variables = {variable.name: variable for variable in description.modelVariables}
        experiment = description.defaultExperiment
        self.tolerance = float(experiment.tolerance) if experiment and experiment.tolerance else 1e-4

    def has(self, *names):
        return all(name in self.variables for name in names)

    def __getitem__(self, name):
        return float(self.variables[name].start or 0)


def is_jump(times, places):
    return np.isin(np.round(times * 1e6), np.round(np.asarray(list(places)) * 1e6))


# Blocks of the Modelica Standard Library.


def sources(model, block):
    """Returns the output of a block of Modelica.Blocks.Sources as a function of time, and the times of its jumps, both as
    the library's documentation defines them. For any other block, returns None."""
    offset = model["offset"] if model.has("offset") else 0.0
    start = model["startTime"] if model.has("startTime") else 0.0
    frequency = model["f"] if model.has("f") else model["freqHz"] if model.has("freqHz") else 0.0

    def later(signal):
        return lambda t: offset + np.where(t < start, 0.0, signal(np.maximum(t - start, 0.0)))

    def periodic(signal):
        period = model["period"]
        return later(lambda t: model["amplitude"] * signal(t - period * np.floor(t / period + 1e-9), period))

    def trapezoid(t, period):
        rising, width, falling = model["rising"], model["width"], model["falling"]
        return np.interp(t, [0, rising, rising + width, rising + width + falling, period], [0, 1, 1, 0, 0])

    def exponentials(t):
        rise, fall, length = model["riseTimeConst"], model["fallTimeConst"], model["riseTime"]
        top = model["outMax"] * (1 - math.exp(-length / rise))
        return np.where(t < length, model["outMax"] * (1 - np.exp(-t / rise)), top * np.exp(-(t - length) / fall))

    def wave(function):
        return later(lambda t: model["amplitude"] * function(2 * np.pi * frequency * t + model["phase"]))

    signals = {
        "Clock": lambda: later(lambda t: t),
        "ContinuousClock": lambda: later(lambda t: t),
        "Constant": lambda: lambda t: np.full_like(t, model["k"]),
        "Step": lambda: later(lambda t: np.full_like(t, model["height"])),
        "Ramp": lambda: later(lambda t: model["height"] * np.clip(t / max(model["duration"], 1e-300), 0, 1)),
        "Sine": lambda: wave(np.sin),
        "Cosine": lambda: wave(np.cos),
        "ExpSine": lambda: later(lambda t: model["amplitude"] * np.exp(-t * model["damping"]) *
                                 np.sin(2 * np.pi * frequency * t + model["phase"])),
        "Exponentials": lambda: later(exponentials),
        "Pulse": lambda: periodic(lambda t, period: np.where(t < period * model["width"] / 100, 1.0, 0.0)),
        "SawTooth": lambda: periodic(lambda t, period: t / period),
        "Trapezoid": lambda: periodic(trapezoid),
    }
    if block not in signals:
        return None
    edges = {start}
    if block in ("Pulse", "SawTooth"):
        parts = (0.0, model["width"] / 100) if block == "Pulse" else (0.0,)
        edges |= {start + (k + part) * model["period"] for k in range(2000) for part in parts}
    return signals[block](), edges


def modelica_block(model):
    match = re.fullmatch(r"Modelica\.Blocks\.(\w+)\.(\w+)", model.name)
    if not match:
        return None
    package, block = match.groups()
    where = f"documentation of {model.name}"
    if package == "Sources":
        found = sources(model, block)
        if not found:
            return None
        signal, edges = found
        return Truth("analytic", where, lambda t: {"y": signal(t)}, jumps=lambda t: is_jump(t, edges))
    inputs = {"u": 1.25, "u1": 1.5, "u2": -0.25, "u3": 2.0}
    inputs = {name: value for name, value in inputs.items() if model.has(name)}
    u = inputs.get
    constants = {
        "Add": lambda: model["k1"] * u("u1") + model["k2"] * u("u2"),
        "Add3": lambda: model["k1"] * u("u1") + model["k2"] * u("u2") + model["k3"] * u("u3"),
        "Gain": lambda: model["k"] * u("u"),
        "Feedback": lambda: u("u1") - u("u2"),
        "Product": lambda: u("u1") * u("u2"),
        "Limiter": lambda: min(max(u("u"), -model["uMax"]), model["uMax"]),
    }
    if block in constants:
        return Truth("analytic", where, lambda t: {"y": np.full_like(t, constants[block]())}, inputs)
    if block == "Integrator":
        return Truth("analytic", where, lambda t: {"y": model["y_start"] + model["k"] * u("u") * (t - t[0])}, inputs)
    return None


# Differential equations.


def euler(rate, start, times, step, event=None):
    """Returns a solution by explicit Euler with one row per time. `step` must divide the distances between `times`."""
    state = np.array(start, dtype=float)
    rows = [state.copy()]
    for before, after in zip(times, times[1:]):
        parts = max(1, round((after - before) / step))
        for _ in range(parts):
            state = state + (after - before) / parts * np.asarray(rate(state))
            if event:
                state = event(state)
        rows.append(state.copy())
    return np.array(rows)


def solved(rate, start, times):
    solution = scipy.integrate.solve_ivp(lambda t, x: rate(x), (times[0], times[-1]), start, method="DOP853", rtol=1e-11,
                                         atol=1e-12, t_eval=times)
    return solution.y.T


def linear(matrix, constant, start):
    """Returns the solution of x' = A x + b by the matrix exponential."""
    n = len(start)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n] = matrix, constant
    first = np.append(start, 1.0)

    def values(times):
        return np.array([(scipy.linalg.expm(whole * (t - times[0])) @ first)[:n] for t in times])
    return values


def columns(names, rows):
    return {name: rows[:, i] for i, name in enumerate(names)}


def of_method(names, truth, rate, start, internal=None, event=None):
    """Returns a function that computes the permitted deviation from the exact solution for explicit Euler. `internal` is
    the step of the FMU's solver. If it is None, the solver uses the communication step."""
    def bound(times, step):
        exact = truth(times)
        coarse = columns(names, euler(rate, start, times, internal or step, event))
        return {name: BOUND_OF_METHOD * np.max(np.abs(coarse[name] - exact[name])) +
                ROUNDING * np.max(np.abs(exact[name])) for name in names}
    return bound


def of_tolerance(model, truth):
    """Returns a function that computes the permitted deviation for a solver with error control, and a text about it. The
    deviation is that of 100 steps whose errors add up."""
    steps = 100

    def bound(times, _step):
        return {name: steps * model.tolerance * max(np.max(np.abs(values)), 1e-3) for name, values in truth(times).items()}
    return bound, f"{steps} x tolerance"


def linear_truth(model, names, matrix, constant, start, source, inputs=None, method="euler", **more):
    solution = linear(matrix, constant, start)
    matrix, constant = np.asarray(matrix, dtype=float), np.asarray(constant, dtype=float)

    def truth(times):
        return columns(names, solution(times))
    if method == "euler":
        bound = of_method(names, truth, lambda x: matrix @ x + constant, start)
        text = "explicit Euler with the communication step"
    else:
        bound, text = of_tolerance(model, truth)
    return Truth("analytic", source, truth, inputs or {}, bound, text, **more)


OMS = "equations in the sources of OMSimulator-testsuite"


def openmodelica(model):
    if model.name == "HelloWorld" or model.name == "HelloWorldWithInput":
        return linear_truth(model, ["x"], [[model["a"]]], [0.0], [model["x_start"]], f"x' = a x ({OMS})")
    if model.name == "Lin2DimODE":
        matrix = [[model["a11"], model["a12"]], [model["a21"], model["a22"]]]
        return linear_truth(model, ["x1", "x2"], matrix, [0, 0], [model["x1_start"], model["x2_start"]], f"x' = A x ({OMS})")
    if model.name == "MassSpring":
        force = 30.0
        return linear_truth(model, ["v", "x"], [[-model["B"] / model["M"], -model["k"] / model["M"]], [1, 0]],
                            [-force / model["M"], 0], [0, 0], "M v' = -B v - k x - f (sources in the FMU)", {"f": force})
    if model.name == "DualMassOscillator.System1":
        mass, rest = model["m1"], model["springDamper1.s_rel0"] + model["fixed.s0"]
        return linear_truth(model, ["s1", "v1"], [[0, 1], [-model["c1"] / mass, -model["d1"] / mass]],
                            [0, model["c1"] * rest / mass], [model["s1_start"] + 0.01, model["v1_start"]],
                            f"m s'' = -c (s - s0) - d v ({OMS})", {"s1_start": model["s1_start"] + 0.01}, step=1e-5, steps=1000)
    if model.name == "source1" and model.has("A", "omega"):
        return Truth("analytic", "y = A sin(omega t) (sources in the FMU)", lambda t: {"y": model["A"] * np.sin(model["omega"] * t)})
    if model.name == "adder1":
        return Truth("analytic", f"y = x1 + x2 ({OMS})", lambda t: {"y": np.full_like(t, 1.25)}, {"x1": 1.5, "x2": -0.25})
    return None


# Reference FMUs, and older FMUs of the same models.


def bouncing(height, speed, gravity, damping, stop_speed, times):
    """Returns the free flight between impacts. Each impact reverses the speed and reduces its magnitude."""
    rows, begin, h, v, g = [], times[0], height, speed, gravity
    for t in times:
        while g > 0:
            fall = (v + math.sqrt(v * v + 2 * g * h)) / g
            if t <= begin + fall:
                break
            begin, h, v = begin + fall, 0.0, damping * abs(v - g * fall)
            if v < stop_speed or v < 1e-9:
                v, g = 0.0, 0.0
        s = t - begin
        rows.append((h + v * s - g * s * s / 2, v - g * s))
    return np.array(rows)


def ball(model, names, start, gravity, damping, stop_speed, internal, source):
    def truth(times):
        return {names[0]: bouncing(*start, gravity, damping, stop_speed, times)[:, 0]}

    def event(state):
        return np.array([0.0, damping * abs(state[1])]) if state[0] <= 0 and state[1] < 0 else state

    def bound(times, step):
        coarse = euler(lambda x: (x[1], -gravity), start, times, internal or step, event)
        return {names[0]: BOUND_OF_METHOD * np.max(np.abs(coarse[:, 0] - truth(times)[names[0]])) + ROUNDING}
    return Truth("analytic", source, truth, {}, bound, f"explicit Euler with {f'{internal} s' if internal else 'the communication step'}")


def internal_step(model, usual):
    """Returns the step of a Reference FMU's solver: the step in its description, or the usual step. Old versions use the
    communication step; for them, returns None."""
    said = getattr(model.description.coSimulation, "fixedInternalStepSize", None)
    return float(said) if said else usual if model.has("time") else None


def feedthrough(model):
    new = model.has("Float64_continuous_input")
    values = {"Float64_continuous_": 1.5, "Float64_discrete_": -2.5, "Int32_": 7, "Boolean_": 1,
              "real_continuous_": 1.5, "real_discrete_": -2.5, "int_": 7, "bool_": 1}
    ends = ("input", "output") if new else ("in", "out")
    pairs = {part: value for part, value in values.items() if model.has(part + ends[0], part + ends[1])}
    expected = pairs if new else pairs | {"bool_": 0}  # these also require string_param = "FMI is awesome!"
    return Truth("analytic", "outputs equal inputs (README of the Reference FMUs; sources in the FMU)",
                 lambda t: {part + ends[1]: np.full_like(t, value) for part, value in expected.items()},
                 {part + ends[0]: value for part, value in pairs.items()})


def reference_fmu(model):
    readme = "README of the Reference FMUs"
    if model.name == "BouncingBall" and model.has("h", "v", "g", "e"):
        return ball(model, ["h"], (model["h"], model["v"]), -model["g"], model["e"], 0.1, internal_step(model, 1e-3),
                    f"free flight and impacts ({readme})")
    if model.name == "bouncingBall" and model.has("h", "v", "g", "e"):
        return ball(model, ["h"], (model["h"], model["v"]), model["g"], model["e"], 0.0, None, "free flight and impacts (FMU SDK)")
    if model.name == "Dahlquist" and model.has("x", "k"):
        step = internal_step(model, 0.1)
        named = f"{step} s" if step else "the communication step"

        def truth(times):
            return {"x": model["x"] * np.exp(-model["k"] * (times - times[0]))}
        return Truth("analytic", f"x' = -k x ({readme})", truth, {},
                     of_method(["x"], truth, lambda x: -model["k"] * x, [model["x"]], step), f"explicit Euler with {named}")
    if re.fullmatch(r"VanDerPol|van der Pol oscillator", model.name, re.I) and model.has("x0", "x1", "mu"):
        step = internal_step(model, 0.01)
        longest = {} if step else {"step": 0.01, "steps": 1000}

        def rate(x):
            return np.array([x[1], model["mu"] * (1 - x[0] ** 2) * x[1] - x[0]])

        def truth(times):
            return columns(["x0", "x1"], solved(rate, [model["x0"], model["x1"]], times))
        return Truth("equations", f"Van der Pol ({readme})", truth, {},
                     of_method(["x0", "x1"], truth, rate, [model["x0"], model["x1"]], step),
                     f"explicit Euler with {step or 0.01} s", **longest)
    if model.name == "Stair":
        return Truth("analytic", f"the counter rises each second ({readme})", lambda t: {"counter": 1 + np.floor(t + 1e-9)},
                     jumps=lambda t: is_jump(t, range(0, 100)))
    if model.name == "Resource" and model.has("y"):
        return Truth("analytic", f"the first letter of resources/y.txt, which is a ({readme})", lambda t: {"y": np.full_like(t, 97.0)})
    if model.name == "Feedthrough":
        return feedthrough(model)
    return None


# Other repositories.


def pendulum(model):
    """Returns the known solution of FMIZoo.jl's mass on a spring, with and without a damper or a force."""
    if not model.name.startswith("Spring") or "Friction" in model.name or not model.has("mass.s", "spring.c", "mass.m"):
        return None
    mass, stiffness = model["mass.m"], model["spring.c"]
    damping = model["damper.d"] if model.has("damper.d") else 0.0
    force = 2.0 if model.has("extForce") else 0.0
    rest = model["fixed.s0"] + model["spring.s_rel0"]
    start = [model["mass_s0"] if model.has("mass_s0") else model["mass.s"], model["mass_v0"] if model.has("mass_v0") else model["mass.v"]]
    return linear_truth(model, ["mass.s", "mass.v"], [[0, 1], [-stiffness / mass, -damping / mass]],
                        [0, (stiffness * rest + force) / mass], start, "m s'' = -c (s - s0) - d v + F (documentation of FMIZoo.jl)",
                        {"extForce": force} if force else {}, "tolerance")


def other(model):
    if model.name == "BouncingBall1D":
        bound = 1e-3

        def truth(times):
            radius = model["mass_radius"]
            return {"mass_s": radius + bouncing(model["mass_s_start"] - radius, 0.0, 9.81, model["damping"], 0.0, times)[:, 0]}
        return Truth("analytic", "free flight and impacts (documentation of FMIZoo.jl)", truth, {},
                     lambda times, _step: {"mass_s": bound}, "10 x tolerance")
    if model.name == "IO" and model.has("u_real", "u_boolean", "u_integer"):
        values = {"real": 1.5, "boolean": 1, "integer": 7}
        return Truth("analytic", "outputs equal inputs (documentation of FMIZoo.jl)",
                     lambda t: {f"y_{name}": np.full_like(t, value) for name, value in values.items()},
                     {f"u_{name}": value for name, value in values.items()})
    if model.name.endswith("simulation-platform.vector"):
        values = {0: 1.5, 1: -2.5, 2: 0.25}
        return Truth("analytic", "outputs equal inputs (tests of libcosim)",
                     lambda t: {f"output[{i}]": np.full_like(t, value) for i, value in values.items()},
                     {f"input[{i}]": value for i, value in values.items()}, jumps=lambda t: t <= t[0])
    if model.name == "StateInitExample":
        start, slope = model["Parameters.Integrator1_x0"], model["Parameters.Constant_Value"]
        return Truth("analytic", "the integral of a constant (tests of libcosim)", lambda t: {"Integrator_out1": start + slope * (t - t[0])})
    if model.name == "Chassis" and model.has("mass", "force"):
        force = 400.0
        acceleration = -force / model["mass"]
        return Truth("analytic", "x'' = -F / m (sources in the FMU)",
                     lambda t: {"velocity": acceleration * (t - t[0]), "position": acceleration * (t - t[0]) ** 2 / 2}, {"force": force},
                     lambda t, step: {"velocity": 1e-6 * t[-1], "position": 1e-6 * t[-1] ** 2}, "1e-6 of the largest value")
    if model.name == "MassSpringDamper1":
        force, mass = 0.5, model["m1"]
        truth = linear_truth(model, ["x1", "v1"], [[0, 1], [-model["c1"] / mass, -model["d1"] / mass]], [0, force / mass],
                             [model["x1_initial"], model["v1_initial"]], "m x'' = -c x - d v + F (examples of INTO-CPS)", {"fk": force})
        truth.bound = lambda times, _step: {"x1": 1e-6, "v1": 1e-6}
        truth.bound_text = "1e-6: a method of fourth order in steps of 0.01 s"
        return truth
    if model.name == "watertank-c" and model.has("level", "valve"):
        return Truth("analytic", "the level rises by 1 in each step (sources in the FMU)", lambda t: {"level": 1.0 + np.arange(len(t))})
    if model.name == "WaterTank.Control" and model.has("maxlevel"):
        return Truth("analytic", "the valve is open above the maximum level (examples of INTO-CPS)",
                     lambda t: {"valve": np.full_like(t, 1.0)}, {"level": model["maxlevel"] + 1}, jumps=lambda t: t <= t[0])
    return None


def reference_file(fmu, model):
    """Reads a known solution from `NAME_ref.csv` or `NAME_out.csv` next to the FMU. If there is no such file, or if the FMU
    needs inputs from a file, returns None."""
    stem = fmu.with_suffix("")
    if pathlib.Path(f"{stem}_in.csv").exists():
        return None
    for ending in ("_ref.csv", "_out.csv"):
        path = pathlib.Path(f"{stem}{ending}")
        if path.exists():
            break
    else:
        return None
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    names = [name for name in header[1:] if name in model.variables]
    data = np.array([[float(cell) for cell in row] for row in rows])
    if not names or data.size == 0:
        return None

    def values(times):
        return {name: np.interp(times, data[:, 0], data[:, header.index(name)]) for name in names}
    return Truth("reference file", path.name, values, {},
                 lambda times, _step: {name: 1e-6 * max(np.max(np.abs(column)), 1e-9) for name, column in values(times).items()},
                 "1e-6 of the largest value", lambda times: ~np.isin(np.round(times * 1e9), np.round(data[:, 0] * 1e9)))


def truths_of(fmu, description):
    """Returns all known solutions for an FMU."""
    model = Model(description)
    found = [rule(model) for rule in (modelica_block, openmodelica, reference_fmu, pendulum, other)]
    return [truth for truth in [*found, reference_file(fmu, model)] if truth]


def compare(truth, times, step, found):
    """Returns (ratio, error, text) of the variable with the largest ratio. The ratio is the variable's largest error divided by
    its bound. The FMU agrees with the truth if the ratio is at most 1.

    An FMU may end the run early. If a bound exceeds a quarter of the variable's largest value, the ratio is infinite, because
    such a comparison proves nothing.
    """
    reached = min((len(values) for values in found.values()), default=0)
    if reached < 2:
        return math.inf, math.inf, "no step"
    times = np.asarray(times)[:reached]
    exact = truth.values(times)
    bounds = truth.bound(times, step) if truth.bound else {}
    skipped = truth.jumps(times) if truth.jumps else np.zeros(len(times), dtype=bool)
    worst = (0.0, 0.0, "")
    for name, values in exact.items():
        if name not in found:
            return math.inf, math.inf, f"{name} is not there"
        error = np.where(skipped, 0.0, np.abs(np.asarray(found[name]) - values))
        place = int(np.argmax(error))
        bound = bounds.get(name, ROUNDING * max(np.max(np.abs(values)), 1e-3))
        if name in bounds and bound > USEFUL * np.max(np.abs(values)):
            return math.inf, float(error[place]), f"the bound of {name} is {bound:.1e}, which says nothing"
        if error[place] / bound >= worst[0]:
            worst = (float(error[place] / bound), float(error[place]),
                     f"{name} is {found[name][place]:.6g} instead of {values[place]:.6g} at {times[place]:g} s")
    return worst
