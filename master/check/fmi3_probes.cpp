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

/// Returns the first infinite or NaN element of a Float64 or Float32 as text. Returns an empty text for finite values
/// and other types.
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
  Fmi3Instance instance(library, "run");
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
  Fmi3Instance instance(library, "straight");
  instance.start();
  instance.run(0, steps);
  return instance.outputs();
}

void two_instances(const Fmi3Library& library) {
  const auto alone = straight_run(library, kSteps);
  Fmi3Instance first(library, "first");
  Fmi3Instance second(library, "second");
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
  Fmi3Instance instance(library, "reset");
  instance.start();
  instance.run(0, kSteps);
  instance.reset();
  instance.start();
  instance.run(0, kHalf);
  expect_same(library.witness(), "after fmi3Reset", instance.outputs(), wanted, "reset all that a run changes");
}

void states_restore(const Fmi3Library& library) {
  const auto wanted = straight_run(library, kSteps);
  Fmi3Instance instance(library, "saved");
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

/// Checks that the FMU restores a state without serialization.
void states_restore_in_place(const Fmi3Library& library) {
  const auto wanted = straight_run(library, kSteps);
  Fmi3Instance instance(library, "saved");
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

}  // namespace

std::vector<ChildProbe> fmi3_probes(const Fmi3Target& target) {
  const auto root = target.description->root();
  const auto co_simulation = root.child("CoSimulation");
  const auto probe = [&](std::string name, std::string skipped, void (*run)(const Fmi3Library&),
                         bool is_plain = false) {
    return ChildProbe{std::move(name), std::move(skipped),
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
  const auto traces = no_steps.empty() ? fmi3_trace_scope(target) : TraceScope{.obstacle = no_steps};
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
          probe(traces.check_name(), traces.obstacle, &replay_trace)};
}

}  // namespace mebots::check
