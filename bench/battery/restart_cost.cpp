// SPDX-License-Identifier: Apache-2.0
// Measures the cost of a communication point at which the loads change, so that the integrator must restart. Compares
// ARKODE's ERKStep with CVODE on the cell's equations, and times the step of the complete model.
#include "model.hpp"

#include <arkode/arkode_erkstep.h>
#include <benchmark/benchmark.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <string>

namespace {

using mebots::battery::Cell;
using mebots::battery::Circuit;

constexpr double kStep = 0.002;
constexpr int kSize = 10;  // three states and seven energies, as in the model
const std::string kParams = MEBOTS_PARAMS;

struct Problem {
  Cell cell = mebots::battery::load_cell(kParams + "/cells/bitcraze_250.json");
  double power_w = 9;
  long evaluations = 0;
};

int right_hand_side(double /*t*/, N_Vector y_vector, N_Vector derivative_vector, void* data) {
  auto& problem = *static_cast<Problem*>(data);
  ++problem.evaluations;
  const double* y = N_VGetArrayPointer(y_vector);
  double* dy = N_VGetArrayPointer(derivative_vector);
  const Circuit c = problem.cell.circuit_at(y[0]);
  const double i = mebots::battery::terminal_current_a(c.open_circuit_v - y[1] - y[2], c.series_ohm, problem.power_w);
  dy[0] = -i / problem.cell.capacity_c;
  dy[1] = (i - y[1] / c.pair1_ohm) / c.pair1_farad;
  dy[2] = (i - y[2] / c.pair2_ohm) / c.pair2_farad;
  dy[3] = c.open_circuit_v * i;
  dy[4] = problem.power_w;
  dy[5] = 0;
  dy[6] = c.series_ohm * i * i + y[1] * y[1] / c.pair1_ohm + y[2] * y[2] / c.pair2_ohm;
  dy[7] = y[1] * (i - y[1] / c.pair1_ohm) + y[2] * (i - y[2] / c.pair2_ohm);
  dy[8] = 0;
  dy[9] = 0;
  return 0;
}

int root_functions(double /*t*/, N_Vector y_vector, double* g, void* data) {
  const auto& problem = *static_cast<Problem*>(data);
  const double* y = N_VGetArrayPointer(y_vector);
  const double source_v = problem.cell.open_circuit_v(y[0]) - y[1] - y[2];
  g[0] = mebots::battery::power_limit_w(source_v, problem.cell.series_ohm(y[0]), problem.cell.cut_off_voltage_v) -
         problem.power_w;
  g[1] = y[0];
  g[2] = 1;
  return 0;
}

class Vectors {
 public:
  Vectors() {
    SUNContext_Create(nullptr, &context);
    y = N_VNew_Serial(kSize, context);
    tolerances = N_VNew_Serial(kSize, context);
    double* tolerance = N_VGetArrayPointer(tolerances);
    std::fill(tolerance, tolerance + kSize, 1e-10);
    tolerance[0] = 1e-12;
    N_VConst(0, y);
    N_VGetArrayPointer(y)[0] = 0.9;
  }
  ~Vectors() {
    N_VDestroy(y);
    N_VDestroy(tolerances);
    SUNContext_Free(&context);
  }
  void next(Problem& problem) const {
    double* values = N_VGetArrayPointer(y);
    std::fill(values + 3, values + kSize, 0.0);
    if (values[0] < 0.3) values[0] = 0.9;
    problem.power_w = problem.power_w > 9 ? 8.5 : 9.5;
  }

  SUNContext context = nullptr;
  N_Vector y = nullptr;
  N_Vector tolerances = nullptr;
};

/// Measures `step`, which must restart the integrator, perform one step, and store the reached time in its argument. If
/// the integrator fails, `step` must return false.
void time_steps(benchmark::State& state, Problem& problem, const Vectors& vectors, auto step) {
  for ([[maybe_unused]] auto _ : state) {
    vectors.next(problem);
    double reached = 0;
    if (!step(reached)) state.SkipWithError("the integrator gave up");
  }
  state.counters["rhs per step"] =
      benchmark::Counter(static_cast<double>(problem.evaluations), benchmark::Counter::kAvgIterations);
}

void erkstep(benchmark::State& state, ARKODE_ERKTableID table) {
  Problem problem;
  const Vectors vectors;
  void* memory = ERKStepCreate(right_hand_side, 0, vectors.y, vectors.context);
  ERKStepSVtolerances(memory, 1e-9, vectors.tolerances);
  ERKStepSetUserData(memory, &problem);
  ERKStepSetTableNum(memory, table);
  ERKStepRootInit(memory, 3, root_functions);
  ERKStepSetNoInactiveRootWarn(memory);
  time_steps(state, problem, vectors, [&](double& reached) {
    ERKStepReInit(memory, right_hand_side, 0, vectors.y);
    ERKStepSetInitStep(memory, kStep);
    ERKStepSetStopTime(memory, kStep);
    return ERKStepEvolve(memory, kStep, vectors.y, &reached, ARK_NORMAL) >= 0;
  });
  ERKStepFree(&memory);
}

void erkstep_order_3(benchmark::State& state) {
  erkstep(state, ARKODE_BOGACKI_SHAMPINE_4_2_3);
}
void erkstep_order_4(benchmark::State& state) {
  erkstep(state, ARKODE_ZONNEVELD_5_3_4);
}
void erkstep_order_5(benchmark::State& state) {
  erkstep(state, ARKODE_DORMAND_PRINCE_7_4_5);
}

void cvode_adams(benchmark::State& state) {
  Problem problem;
  const Vectors vectors;
  void* memory = CVodeCreate(CV_ADAMS, vectors.context);
  CVodeInit(memory, right_hand_side, 0, vectors.y);
  CVodeSVtolerances(memory, 1e-9, vectors.tolerances);
  CVodeSetUserData(memory, &problem);
  SUNNonlinearSolver solver = SUNNonlinSol_FixedPoint(vectors.y, 0, vectors.context);
  CVodeSetNonlinearSolver(memory, solver);
  CVodeRootInit(memory, 3, root_functions);
  CVodeSetNoInactiveRootWarn(memory);
  time_steps(state, problem, vectors, [&](double& reached) {
    CVodeReInit(memory, 0, vectors.y);
    CVodeSetStopTime(memory, kStep);
    return CVode(memory, kStep, vectors.y, &reached, CV_NORMAL) >= 0;
  });
  CVodeFree(&memory);
  SUNNonlinSolFree(solver);
}

void whole_model_step(benchmark::State& state) {
  mebots::battery::Parameters parameters;
  mebots::battery::Inputs inputs;
  mebots::battery::Outputs outputs;
  auto model = mebots::battery::Model(parameters, kParams, [](auto, std::string_view) {});
  model.start(inputs, 0, outputs);
  std::int64_t now = 0;
  constexpr std::int64_t kStepNs = 2'000'000;
  for ([[maybe_unused]] auto _ : state) {
    const bool even = (now / kStepNs) % 2 == 0;
    inputs.load_power_w = {even ? 2.1 : 1.9, even ? 0.05 : 0.06, 0.003, 0.96, 0};
    // Charges the cell while its state of charge is below 0.5, so that it never becomes empty.
    inputs.source_power_w = outputs.cell_state_of_charge < 0.5 ? 8 : 0;
    model.step(inputs, now, kStepNs, outputs);
    now += kStepNs;
    benchmark::DoNotOptimize(outputs);
  }
}

BENCHMARK(erkstep_order_3);
BENCHMARK(erkstep_order_4);
BENCHMARK(erkstep_order_5);
BENCHMARK(cvode_adams);
BENCHMARK(whole_model_step);

}  // namespace
