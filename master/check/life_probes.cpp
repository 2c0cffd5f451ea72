// SPDX-License-Identifier: Apache-2.0
#include "behaviour_check.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <set>
#include <vector>

namespace mebots::check {
namespace {

using modeldesc::Causality;
using modeldesc::Initial;
using modeldesc::Type;
using modeldesc::Variability;

void check_versions(const Library& library) {
  const auto& f = library.functions();
  const auto expect = [&](const char* function, const char* said, const char* wanted) {
    if (said == nullptr || std::strcmp(said, wanted) != 0)
      library.witness().error(
          fmt::format("{} returns \"{}\" instead of \"{}\"", function, said == nullptr ? "(null)" : said, wanted),
          "build against the headers of FMI 2.0");
  };
  library.witness().doing("fmi2GetVersion");
  expect("fmi2GetVersion", f.get_version(), "2.0");
  library.witness().doing("fmi2GetTypesPlatform");
  expect("fmi2GetTypesPlatform", f.get_types_platform(), "default");
}

void check_starts(const Library& library) {
  Instance instance(library, "starts");
  instance.setup();
  instance.enter();  // values may be read in this state
  const auto& f = library.functions();
  for (const auto& variable : library.target().model->variables) {
    if (std::holds_alternative<std::monostate>(variable.start) || variable.osmp) continue;
    const bool exact =
        variable.causality == Causality::input || (variable.initial && *variable.initial == Initial::exact);
    if (!exact) continue;
    const auto call = fmt::format("getting {}", variable.name);
    instance.doing(call);
    std::string found;
    std::string wanted;
    const auto* reference = &variable.value_reference;
    if (variable.type == Type::real) {
      fmi2Real value = 0;
      instance.require(call, f.get_real(instance.component(), reference, 1, &value));
      found = fmt::format("{}", value);
      wanted = fmt::format("{}", std::get<double>(variable.start));
    } else if (variable.type == Type::string) {
      fmi2String value = nullptr;
      instance.require(call, f.get_string(instance.component(), reference, 1, &value));
      found = value == nullptr ? "(null)" : value;
      wanted = std::get<std::string>(variable.start);
    } else if (variable.type == Type::boolean) {
      fmi2Boolean value = 0;
      instance.require(call, f.get_boolean(instance.component(), reference, 1, &value));
      found = value == fmi2False ? "false" : "true";
      wanted = std::get<bool>(variable.start) ? "true" : "false";
    } else {
      fmi2Integer value = 0;
      instance.require(call, f.get_integer(instance.component(), reference, 1, &value));
      found = std::to_string(value);
      wanted = std::to_string(std::get<std::int64_t>(variable.start));
    }
    if (found != wanted)
      library.witness().error(fmt::format("{} is {} in initialisation mode; modelDescription.xml declares start {}",
                                          variable.name, found, wanted),
                              "generate library and description from one source");
  }
}

void check_run(const Library& library) {
  const auto& target = library.target();
  Instance instance(library, "run");
  instance.start();
  const auto& variables = library.output_variables(Type::real);
  std::vector<bool> reported(variables.size(), false);
  for (int k = 0; k <= target.steps; ++k) {
    if (k > 0) instance.run(k - 1, k);
    const auto outputs = instance.outputs();
    for (std::size_t i = 0; i < variables.size(); ++i) {
      const double value = outputs.reals[i];
      const auto& variable = *variables[i];
      if (reported[i]) continue;
      if (!std::isfinite(value)) {
        reported[i] = true;
        library.witness().error(fmt::format("{} is {} at {} s", variable.name, value, k * target.step_s),
                                "return fmi2Error or fmi2Discard if no valid result can be computed");
      } else if ((variable.min && value < *variable.min) || (variable.max && value > *variable.max)) {
        reported[i] = true;
        library.witness().warning(
            fmt::format("{} = {} at {} s is outside of its min and max", variable.name, value, k * target.step_s),
            "correct the model or the limits");
      }
    }
  }
  instance.terminate();
}

Outputs straight_run(const Library& library, int steps) {
  Instance instance(library, "straight");
  instance.start();
  instance.run(0, steps);
  return instance.outputs();
}

void expect_same(const Library& library, const std::string& what, const Outputs& found, const Outputs& wanted,
                 const std::string& way_out) {
  const auto difference = library.difference(found, wanted);
  if (!difference.empty()) library.witness().error(fmt::format("{}: {}", what, difference), way_out);
}

void check_two_instances(const Library& library) {
  const int steps = library.target().steps;
  const auto alone = straight_run(library, steps);
  Instance a(library, "first");
  Instance b(library, "second");
  a.start();
  b.start();
  for (int k = 0; k < steps; ++k) {
    a.run(k, k + 1);
    if (k % 2 == 0) b.run(k / 2, k / 2 + 1);  // half the speed
  }
  expect_same(library, "next to another instance", a.outputs(), alone,
              "keep everything in the instance: global and static variables are shared by all instances");
  b.free();
  a.outputs();
}

void check_reset(const Library& library) {
  const int steps = library.target().steps;
  const auto wanted = straight_run(library, steps);
  const auto from = [&](const char* state, auto prepare) {
    Instance instance(library, "reset");
    prepare(instance);
    instance.reset();
    instance.start();
    instance.run(0, steps);
    expect_same(library, fmt::format("after fmi2Reset {}", state), instance.outputs(), wanted,
                "reset every variable and state to its value after fmi2Instantiate");
  };
  from("of a new instance", [](Instance&) {});
  from("in initialisation mode", [](Instance& i) {
    i.setup();
    i.enter();
  });
  from("after some steps", [&](Instance& i) {
    i.start();
    i.run(0, steps / 2);
  });
  from("after fmi2Terminate", [&](Instance& i) {
    i.start();
    i.run(0, steps / 2);
    i.terminate();
  });
}

void check_surroundings(const Library& library) {
  std::set<std::string> reported;
  const auto report = [&](const std::string& when, const std::vector<std::string>& changes) {
    for (const auto& change : changes)
      if (reported.insert(change).second)
        library.witness().warning(fmt::format("{}: {}", when, change),
                                  "do not change what all FMUs of a process share; that belongs to the importing tool");
  };
  report("loading the library", library.changes_at_load());
  Surroundings surroundings;
  {
    Instance instance(library, "surroundings");
    report("fmi2Instantiate", surroundings.changes());
    instance.start();
    report("initialisation", surroundings.changes());
    for (int k = 0; k < library.target().steps; ++k) {
      instance.run(k, k + 1);
      report(fmt::format("fmi2DoStep at {} s", k * library.target().step_s), surroundings.changes());
    }
    instance.terminate();
    report("fmi2Terminate", surroundings.changes());
  }
  report("fmi2FreeInstance", surroundings.changes());
}

constexpr const char* kStateWayOut = "save everything that a later step depends on";

void check_state(const Library& library) {
  const int steps = library.target().steps;
  const auto& f = library.functions();
  const auto wanted = straight_run(library, steps);
  Instance instance(library, "state");
  instance.start();
  instance.run(0, steps / 2);
  fmi2FMUstate state = nullptr;
  instance.doing("fmi2GetFMUstate");
  instance.require("fmi2GetFMUstate", f.get_fmu_state(instance.component(), &state));
  instance.run(steps / 2, steps);
  expect_same(library, "after fmi2GetFMUstate", instance.outputs(), wanted, "saving must not change the instance");
  for (int again = 0; again < 2; ++again) {
    instance.set_state(state);
    instance.run(steps / 2, steps);
    expect_same(library, again == 0 ? "after fmi2SetFMUstate" : "after a second fmi2SetFMUstate of one state",
                instance.outputs(), wanted, kStateWayOut);
  }
  instance.doing("fmi2FreeFMUstate");
  instance.require("fmi2FreeFMUstate", f.free_fmu_state(instance.component(), &state));
  if (state != nullptr)
    library.witness().error("fmi2FreeFMUstate leaves the pointer to the freed state", "set *FMUstate to null");
}

void check_serialization(const Library& library) {
  const int steps = library.target().steps;
  const auto& f = library.functions();
  const auto wanted = straight_run(library, steps);
  std::vector<fmi2Byte> bytes;
  {
    Instance instance(library, "writer");
    instance.start();
    instance.run(0, steps / 2);
    fmi2FMUstate state = nullptr;
    std::size_t size = 0;
    instance.require("fmi2GetFMUstate", f.get_fmu_state(instance.component(), &state));
    instance.doing("fmi2SerializedFMUstateSize");
    instance.require("fmi2SerializedFMUstateSize", f.serialized_fmu_state_size(instance.component(), state, &size));
    bytes.resize(size);
    instance.doing("fmi2SerializeFMUstate");
    instance.require("fmi2SerializeFMUstate", f.serialize_fmu_state(instance.component(), state, bytes.data(), size));
    instance.require("fmi2FreeFMUstate", f.free_fmu_state(instance.component(), &state));
  }
  // Frees the instance that wrote the state, because the state must not contain its addresses.
  Instance instance(library, "reader");
  instance.setup();
  instance.enter();
  instance.exit();
  fmi2FMUstate state = nullptr;
  instance.doing("fmi2DeSerializeFMUstate");
  instance.require("fmi2DeSerializeFMUstate",
                   f.deserialize_fmu_state(instance.component(), bytes.data(), bytes.size(), &state));
  instance.set_state(state);
  instance.run(steps / 2, steps);
  expect_same(library, "after restoring a serialised state in another instance", instance.outputs(), wanted,
              kStateWayOut);
  instance.require("fmi2FreeFMUstate", f.free_fmu_state(instance.component(), &state));
}

/// Updates the largest magnitude of each Real output, which scales differences.
void widen(std::vector<double>& magnitudes, const Outputs& outputs) {
  for (std::size_t i = 0; i < magnitudes.size(); ++i)
    magnitudes[i] = std::max(magnitudes[i], std::abs(outputs.reals[i]));
}

void check_half_steps(const Library& library, double tolerance) {
  const auto& target = library.target();
  const double h = target.step_s;
  const auto& variables = library.output_variables(Type::real);
  std::vector<double> magnitudes(variables.size());
  Instance whole(library, "whole");
  Instance halves(library, "halves");
  whole.start();
  halves.start();
  for (int k = 0; k < target.steps; ++k) {
    whole.run(k, k + 1);
    halves.step(k * h, h / 2);
    halves.step(k * h + h / 2, h / 2);
    widen(magnitudes, whole.outputs());
  }
  const auto a = whole.outputs();
  const auto b = halves.outputs();
  for (std::size_t i = 0; i < variables.size(); ++i) {
    if (variables[i]->variability != Variability::continuous) continue;
    const double difference = std::abs(a.reals[i] - b.reals[i]);
    if (difference <= tolerance * magnitudes[i]) continue;
    library.witness().warning(
        fmt::format("{}: {} after {} steps of {} s, but {} after twice as many half steps. The difference is {:.2g} of "
                    "the largest magnitude, and {:g} is allowed",
                    variables[i]->name, a.reals[i], target.steps, h, b.reals[i], difference / magnitudes[i], tolerance),
        "use shorter steps inside the FMU, declare a smaller stepSize in DefaultExperiment, or allow more with "
        "--half-step-tolerance");
  }
}

void check_free_orders(const Library& library) {
  const int steps = library.target().steps;
  library.witness().doing("fmi2FreeInstance of a null pointer");
  library.functions().free_instance(nullptr);
  const auto freed = [&](const char* when, auto prepare) {
    Instance instance(library, "free");
    prepare(instance);
    library.witness().doing(fmt::format("fmi2FreeInstance {}", when));
    library.functions().free_instance(instance.component());
    instance.forget();
  };
  freed("of a new instance", [](Instance&) {});
  freed("after fmi2SetupExperiment", [](Instance& i) { i.setup(); });
  freed("in initialisation mode", [](Instance& i) {
    i.setup();
    i.enter();
  });
  freed("without fmi2Terminate", [&](Instance& i) {
    i.start();
    i.run(0, steps);
  });
  freed("after fmi2Terminate", [&](Instance& i) {
    i.start();
    i.terminate();
  });
}

struct Holdings {
  std::size_t files = 0;
  std::size_t mappings = 0;
  std::size_t threads = 0;
  std::size_t heap_bytes = 0;
};

std::size_t entries(const char* folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
  return count;
}

Holdings holdings() {
  Holdings now;
  now.files = entries("/proc/self/fd");
  now.threads = entries("/proc/self/task");
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) ++now.mappings;
  const auto info = mallinfo2();
  now.heap_bytes = info.uordblks + info.hblkhd;
  return now;
}

/// A resource that instances may leak.
struct Resource {
  const char* name;
  std::size_t Holdings::*count;
  std::size_t noise;
};

constexpr int kCycles = 100;
constexpr std::array kResources = {
    Resource{"open files", &Holdings::files, 0},
    Resource{"threads", &Holdings::threads, 0},
    Resource{"memory mappings", &Holdings::mappings, kCycles / 4},
    Resource{"bytes of heap", &Holdings::heap_bytes, 4096},
};

/// Returns the smallest growth of a resource between two successive measurements. A leak grows every time, the caches
/// of the allocator do not.
std::size_t smallest_growth(const std::vector<Holdings>& measured, const Resource& resource) {
  std::size_t smallest = std::numeric_limits<std::size_t>::max();
  for (std::size_t i = 1; i < measured.size(); ++i) {
    const auto before = measured[i - 1].*resource.count;
    const auto after = measured[i].*resource.count;
    smallest = std::min(smallest, after > before ? after - before : 0);
  }
  return smallest;
}

void check_growth(const Library& library) {
  constexpr int kWarmUp = 10;
  constexpr std::size_t kLeastRounds = 2;
  constexpr std::size_t kMostRounds = 5;
  const auto run_instances = [&](int count) {
    for (int i = 0; i < count; ++i) {
      Instance instance(library, "cycle");
      instance.start();
      instance.run(0, 2);
      instance.terminate();
    }
  };
  run_instances(kWarmUp);
  std::vector<Holdings> measured = {holdings()};
  const auto grows = [&](const Resource& resource) { return smallest_growth(measured, resource) > resource.noise; };
  while (measured.size() <= kLeastRounds ||
         (measured.size() <= kMostRounds && std::ranges::any_of(kResources, grows))) {
    run_instances(kCycles);
    measured.push_back(holdings());
  }
  for (const auto& resource : kResources) {
    if (grows(resource))
      library.witness().error(fmt::format("{} instances were freed and leaked {} {}", kCycles,
                                          smallest_growth(measured, resource), resource.name),
                              "release in fmi2FreeInstance what fmi2Instantiate and the run allocated");
  }
}

}  // namespace

std::vector<Probe> life_probes(const Target& target, double half_step_tolerance) {
  const auto& flags = *target.model->co_simulation;
  const std::string once =
      flags.can_be_instantiated_only_once_per_process ? "canBeInstantiatedOnlyOncePerProcess is true" : "";
  const std::string no_state = flags.can_get_and_set_fmu_state ? "" : "canGetAndSetFMUstate is false";
  const std::string no_bytes = flags.can_serialize_fmu_state ? once : "canSerializeFMUstate is false";
  const std::string fixed_step =
      flags.can_handle_variable_communication_step_size ? once : "canHandleVariableCommunicationStepSize is false";
  const auto traces = find_traces(target.folder);
  const auto scope = scope_of(traces, *target.model);
  std::vector<Probe> probes;
  const auto add = [&](Level level, std::string name, std::function<void(const Library&)> run,
                       std::string skipped = "") {
    probes.push_back({std::move(name), std::move(run), std::move(skipped), Severity::error, level});
  };
  using enum Level;
  add(interoperable, "version and platform are those of FMI 2.0", check_versions);
  add(interoperable, "a run has finite outputs within their limits", check_run);
  probes.push_back(stop_time_probe());
  add(interoperable, "the process is unchanged", check_surroundings);
  add(standard, "start values are those of the description", check_starts);
  add(interoperable, "two instances do not disturb each other", check_two_instances, once);
  add(standard, "reset equals a fresh instance", check_reset, once);
  add(standard, "a run from a restored state equals the straight run", check_state, no_state.empty() ? once : no_state);
  add(standard, "another instance continues from a serialised state", check_serialization, no_bytes);
  add(
      pedantic, fmt::format("half steps change no output by more than {:g} of its magnitude", half_step_tolerance),
      [half_step_tolerance](const Library& library) { check_half_steps(library, half_step_tolerance); }, fixed_step);
  add(interoperable, "an instance can be freed at any time", check_free_orders);
  add(standard, "100 instances leak nothing", check_growth);
  add(
      standard, scope.check_name(), [traces](const Library& library) { replay(library, *traces); }, scope.obstacle);
  return probes;
}

}  // namespace mebots::check
