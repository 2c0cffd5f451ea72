// SPDX-License-Identifier: Apache-2.0
#include "fmi3_probes.hpp"

#include "fmi3_instance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace mebots::check {
namespace {

constexpr int kSteps = 20;
constexpr int kHalf = kSteps / 2;
using Kind = Fmi3Instance::Kind;

/// Returns the first infinite element of a Float64 or Float32; empty if there is none.
std::string not_finite(const Fmi3Value& value) {
  const auto look = [&]<typename T>(T number) -> std::string {
    constexpr std::size_t kSize = sizeof(T);
    for (std::size_t i = 0; i + kSize <= value.bytes.size(); i += kSize) {
      std::memcpy(&number, value.bytes.data() + i, kSize);
      if (!std::isfinite(number)) return fmt::format("{} is {}", value.variable->name, number);
    }
    return {};
  };
  if (value.variable->type == "Float64") return look(0.0);
  return value.variable->type == "Float32" ? look(0.0F) : std::string();
}

void expect_same(Witness& witness, std::string_view what, const Fmi3Values& found, const Fmi3Values& wanted,
                 std::string way_out) {
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (found[i].bytes == wanted[i].bytes) continue;
    witness.error(fmt::format("{}: {} has other bits", what, wanted[i].variable->name), std::move(way_out));
    return;
  }
}

void check_version(const Fmi3Library& library) {
  library.witness().doing("fmi3GetVersion");
  const char* const version = library.find<decltype(fmi3GetVersion)>("fmi3GetVersion")();
  if (version == nullptr || !std::string_view(version).starts_with("3."))
    library.witness().error(fmt::format("fmi3GetVersion says \"{}\"", version == nullptr ? "(null)" : version),
                            "build against the headers of FMI 3.0");
}

void plain_run(const Fmi3Library& library) {
  check_version(library);
  Fmi3Instance instance(library, Kind::co_simulation, "run");
  instance.start();
  for (int k = 0; k < kSteps; ++k) {
    instance.run(k, k + 1);
    for (const auto& value : instance.outputs()) {
      const auto text = not_finite(value);
      if (text.empty()) continue;
      library.witness().error(fmt::format("{} after step {}", text, k + 1),
                              "return fmi3Error or fmi3Discard if no valid result can be computed");
      return;
    }
  }
  instance.terminate();
}

Fmi3Values straight_run(const Fmi3Library& library, int steps) {
  Fmi3Instance instance(library, Kind::co_simulation, "straight");
  instance.start();
  instance.run(0, steps);
  return instance.outputs();
}

void two_instances(const Fmi3Library& library) {
  const auto alone = straight_run(library, kSteps);
  Fmi3Instance first(library, Kind::co_simulation, "first");
  Fmi3Instance second(library, Kind::co_simulation, "second");
  first.start();
  second.start();
  for (int k = 0; k < kSteps; ++k) {
    first.run(k, k + 1);
    if (k % 2 == 0) second.run(k / 2, k / 2 + 1);
  }
  expect_same(library.witness(), "next to another instance", first.outputs(), alone,
              "keep everything in the instance: global and static variables are shared by all instances");
}

void reset_is_a_fresh_start(const Fmi3Library& library) {
  const auto wanted = straight_run(library, kHalf);
  Fmi3Instance instance(library, Kind::co_simulation, "reset");
  instance.start();
  instance.run(0, kSteps);
  instance.reset();
  instance.start();
  instance.run(0, kHalf);
  expect_same(library.witness(), "after fmi3Reset", instance.outputs(), wanted, "reset all that a run changes");
}

void states_restore(const Fmi3Library& library) {
  const auto wanted = straight_run(library, kSteps);
  Fmi3Instance instance(library, Kind::co_simulation, "saved");
  instance.start();
  instance.run(0, kHalf);
  const auto bytes = instance.serialized();
  instance.run(kHalf, kSteps);
  expect_same(library.witness(), "after fmi3GetFMUState", instance.outputs(), wanted, "saving must change nothing");
  instance.restore(bytes);
  instance.run(kHalf, kSteps);
  expect_same(library.witness(), "after fmi3SetFMUState", instance.outputs(), wanted,
              "save all that a step depends on");
}

/// Restores a state without serializing it.
void states_restore_in_place(const Fmi3Library& library) {
  const auto wanted = straight_run(library, kSteps);
  Fmi3Instance instance(library, Kind::co_simulation, "saved");
  instance.start();
  instance.run(0, kHalf);
  fmi3FMUState state = nullptr;
  MEBOTS_CALL(instance, fmi3GetFMUState, &state);
  instance.run(kHalf, kSteps);
  MEBOTS_CALL(instance, fmi3SetFMUState, state);
  instance.run(kHalf, kSteps);
  expect_same(library.witness(), "after fmi3SetFMUState", instance.outputs(), wanted,
              "save all that a step depends on");
  MEBOTS_CALL(instance, fmi3FreeFMUState, &state);
}

/// Integrates model exchange by explicit Euler: sufficient to check that derivatives are finite and events end.
class Euler {
 public:
  Euler(const Fmi3Library& library, const char* name)
      : library_(library), instance_(library, Kind::model_exchange, name) {
    instance_.start();
    settle_events();
    std::size_t count = 0;
    MEBOTS_CALL(instance_, fmi3GetNumberOfContinuousStates, &count);
    states_.resize(count);
    derivatives_.resize(count);
    read_states();
  }

  Fmi3Instance& instance() { return instance_; }
  const std::vector<double>& states() const { return states_; }

  void read_states() {
    if (!states_.empty()) MEBOTS_CALL(instance_, fmi3GetContinuousStates, states_.data(), states_.size());
  }

  void run(int first, int last) {
    for (int k = first; k < last && !ended_; ++k) step(k);
  }

 private:
  void step(int k) {
    if (!states_.empty())
      MEBOTS_CALL(instance_, fmi3GetContinuousStateDerivatives, derivatives_.data(), derivatives_.size());
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (!std::isfinite(derivatives_[i]))
        throw Fmi3Refused(fmt::format("the derivative of state {} is {} at step {}", i, derivatives_[i], k));
      states_[i] += library_.step_s() * derivatives_[i];
    }
    MEBOTS_CALL(instance_, fmi3SetTime, library_.start_s() + (k + 1) * library_.step_s());
    if (!states_.empty()) MEBOTS_CALL(instance_, fmi3SetContinuousStates, states_.data(), states_.size());
    bool event = false;
    MEBOTS_CALL(instance_, fmi3CompletedIntegratorStep, true, &event, &ended_);
    const bool has_time_event = next_event_s_ <= library_.start_s() + (k + 1) * library_.step_s();
    if (!event && !has_time_event) return;
    MEBOTS_CALL(instance_, fmi3EnterEventMode);
    settle_events();
    read_states();
  }

  void settle_events() {
    constexpr int kMost = 1000;
    bool again = true;
    for (int i = 0; again; ++i) {
      if (i == kMost)
        throw Fmi3Refused(fmt::format("fmi3UpdateDiscreteStates requests another update after {} updates", kMost));
      bool nominals = false;
      bool values = false;
      bool defined = false;
      double next_s = 0;
      MEBOTS_CALL(instance_, fmi3UpdateDiscreteStates, &again, &ended_, &nominals, &values, &defined, &next_s);
      next_event_s_ = defined ? next_s : HUGE_VAL;
    }
    MEBOTS_CALL(instance_, fmi3EnterContinuousTimeMode);
  }

  const Fmi3Library& library_;
  Fmi3Instance instance_;
  std::vector<double> states_;
  std::vector<double> derivatives_;
  double next_event_s_ = HUGE_VAL;
  bool ended_ = false;
};

void derivatives_are_finite(const Fmi3Library& library) {
  check_version(library);
  Euler(library, "run").run(0, kSteps);
}

void exchanged_states_restore(const Fmi3Library& library) {
  Euler straight(library, "straight");
  straight.run(0, kHalf);
  fmi3FMUState state = nullptr;
  MEBOTS_CALL(straight.instance(), fmi3GetFMUState, &state);
  straight.run(kHalf, kSteps);
  const auto wanted = straight.states();
  MEBOTS_CALL(straight.instance(), fmi3SetFMUState, state);
  straight.read_states();
  straight.run(kHalf, kSteps);
  if (straight.states() != wanted)
    library.witness().error("after fmi3SetFMUState, the continuous states have other bits",
                            "save all that derivatives and events depend on");
  MEBOTS_CALL(straight.instance(), fmi3FreeFMUState, &state);
}

}  // namespace

std::vector<Fmi3Probe> fmi3_probes(const Fmi3Target& target) {
  const auto root = target.description->root();
  const auto co_simulation = root.child("CoSimulation");
  const auto model_exchange = root.child("ModelExchange");
  const auto probe = [&](const char* name, std::string skipped, void (*run)(const Fmi3Library&),
                         bool is_plain = false) {
    return Fmi3Probe{name, std::move(skipped),
                     [target, run](Witness& witness) {
                       try {
                         run(Fmi3Library(target, witness));
                       } catch (const Fmi3Refused& refused) {
                         witness.error(refused.what(), "see the messages that the FMU logged");
                       }
                     },
                     is_plain};
  };
  const std::string no_steps = co_simulation ? "" : "the FMU does not offer co-simulation";
  const auto unless = [](const std::string& reason, bool holds, const char* other) {
    return !reason.empty() ? reason : holds ? "" : std::string(other);
  };
  const bool has_states = co_simulation.attribute("canGetAndSetFMUState").as_bool();
  const bool serializes = co_simulation.attribute("canSerializeFMUState").as_bool();
  const std::string no_solver = model_exchange ? "" : "the FMU does not offer model exchange";
  return {probe("a plain run reaches its end with finite outputs", no_steps, &plain_run, true),
          probe("two instances do not disturb each other",
                unless(no_steps, !co_simulation.attribute("canBeInstantiatedOnlyOncePerProcess").as_bool(),
                       "the FMU says canBeInstantiatedOnlyOncePerProcess"),
                &two_instances),
          probe("reset equals a fresh start", no_steps, &reset_is_a_fresh_start),
          probe("a saved state restores", unless(no_steps, has_states, "the FMU does not offer canGetAndSetFMUState"),
                &states_restore_in_place),
          probe("a serialised state restores",
                unless(no_steps, serializes, "the FMU does not offer canSerializeFMUState"), &states_restore),
          probe("derivatives are finite, and events end", no_solver, &derivatives_are_finite, true),
          probe("a saved state of model exchange restores",
                unless(no_solver, model_exchange.attribute("canGetAndSetFMUState").as_bool(),
                       "the FMU does not offer canGetAndSetFMUState"),
                &exchanged_states_restore)};
}

}  // namespace mebots::check
