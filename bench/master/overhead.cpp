// SPDX-License-Identifier: Apache-2.0
// Measures the master's cost in addition to the FMU calls. Alternates in one process between a bare loop over the FMU's
// C functions and Simulation. Also measures the cost of single calls. Usage: bench_master_overhead PASSTHROUGH.fmu
// [REPEATS]
#include "fmi/call/foreign_call.hpp"
#include "fmi/fmu.hpp"
#include "message/message_hub.hpp"
#include "resolve/resolve.hpp"
#include "run/simulation.hpp"
#include "slave/fmi/fmi2_slave.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

namespace {

using namespace mebots::master;

class Silent final : public MessageSink {
 public:
  void message(const mebots::Message&) override {}
};

struct Shape {
  const char* name;
  int instances;
  int connections;
};

constexpr std::int64_t kStepNs = 100'000'000;
constexpr std::int64_t kInstanceSteps = 4'000'000;  // per measurement: long compared with the clock's resolution

/// Returns the processor time of this thread.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_of(auto work) {
  const double start = cpu_seconds();
  work();
  return cpu_seconds() - start;
}

SystemDescription system_of(const Shape& shape, const std::filesystem::path& fmu, std::int64_t steps) {
  SystemDescription system;
  system.name = shape.name;
  system.step = exact_time_of(kStepNs);
  system.stop_time_ns = steps * kStepNs;
  for (int i = 0; i < shape.instances; ++i) {
    auto& instance = system.instances.emplace_back();
    instance.name = fmt::format("i{}", i);
    instance.fmu = fmu.string();
    instance.fmu_path = fmu;
  }
  for (int i = 0; i < shape.connections; ++i) {
    const int to = (i + 1) % shape.instances;
    auto& connection = system.connections.emplace_back();
    connection.from = {fmt::format("i{}", i), "y"};
    connection.to = {fmt::format("i{}", to), "u"};
  }
  system.instances[0].parameters.push_back({"u", 1.0, "bench"});
  if (shape.connections == shape.instances) system.instances[0].parameters.clear();
  return system;
}

/// Returns the nanoseconds per instance and step of the necessary calls: set u, step, get y.
double bare(const Shape& shape, Fmu& fmu, std::int64_t steps) {
  const auto& f = fmu.functions<Fmi2Functions>();
  fmi2CallbackFunctions callbacks{};
  callbacks.allocateMemory = &std::calloc;
  callbacks.freeMemory = &std::free;
  std::vector<fmi2Component> components;
  for (int i = 0; i < shape.instances; ++i) {
    components.push_back(f.instantiate("bare", fmi2CoSimulation, fmu.description().guid.c_str(),
                                       fmu.resource_uri().c_str(), &callbacks, fmi2False, fmi2False));
    f.setup_experiment(components.back(), fmi2False, 0, 0, fmi2False, 0);
    f.enter_initialization_mode(components.back());
    f.exit_initialization_mode(components.back());
  }
  const fmi2ValueReference u = fmu.description().find("u")->value_reference;
  const fmi2ValueReference y = fmu.description().find("y")->value_reference;
  const auto count = static_cast<std::size_t>(shape.instances);
  const auto connections = static_cast<std::size_t>(shape.connections);
  std::vector<double> values(count, 0.0);
  const double h = 1e-9 * static_cast<double>(kStepNs);
  const double time = seconds_of([&] {
    for (std::int64_t k = 0; k < steps; ++k) {
      for (std::size_t i = 0; i < connections; ++i) f.set_real(components[(i + 1) % count], &u, 1, &values[i]);
      for (std::size_t i = 0; i < count; ++i) f.do_step(components[i], static_cast<double>(k) * h, h, fmi2False);
      for (std::size_t i = 0; i < connections; ++i) f.get_real(components[i], &y, 1, &values[i]);
    }
  });
  for (fmi2Component component : components) f.free_instance(component);
  return time * 1e9 / static_cast<double>(steps * shape.instances);
}

double by_master(const Shape& shape, const std::filesystem::path& fmu, FmuLibrary& library, std::int64_t steps) {
  const auto system = system_of(shape, fmu, steps);
  const auto resolved = resolve(system, library);
  Silent silent;
  Simulation simulation(resolved, silent);
  simulation.initialize();
  const double time = seconds_of([&] { simulation.run(); });
  return time * 1e9 / static_cast<double>(steps * shape.instances);
}

/// Times of a call of fmi2GetReal [ns]. `watched` includes the check of the floating-point environment. `by_master`
/// also includes setting the instance for callbacks and checking the result.
struct CallCosts {
  double bare, watched, by_master;
};

CallCosts call_costs(const std::shared_ptr<Fmu>& fmu) {
  Silent silent;
  Fmi2Slave slave("it", fmu, {}, silent);
  slave.setup_experiment({});
  slave.enter_initialization();
  slave.exit_initialization();
  const auto& f = fmu->functions<Fmi2Functions>();
  fmi2CallbackFunctions callbacks{};
  callbacks.allocateMemory = &std::calloc;
  callbacks.freeMemory = &std::free;
  const auto component = f.instantiate("bare", fmi2CoSimulation, fmu->description().guid.c_str(),
                                       fmu->resource_uri().c_str(), &callbacks, fmi2False, fmi2False);
  f.setup_experiment(component, fmi2False, 0, 0, fmi2False, 0);
  f.enter_initialization_mode(component);
  f.exit_initialization_mode(component);
  const fmi2ValueReference y[] = {fmu->description().find("y")->value_reference};
  double value[] = {0.0};
  const auto floats = FloatEnvironment::now();
  int changes = 0;
  const auto ns_of = [](auto call) {
    return seconds_of([&] {
             for (std::int64_t k = 0; k < kInstanceSteps; ++k) call();
           }) *
           1e9 / static_cast<double>(kInstanceSteps);
  };
  CallCosts costs{};
  costs.bare = ns_of([&] { f.get_real(component, y, 1, value); });
  costs.watched = ns_of([&] {
    f.get_real(component, y, 1, value);
    if (FloatEnvironment::now() != floats) ++changes;
  });
  costs.by_master = ns_of([&] { slave.get_reals(y, value); });
  f.free_instance(component);
  if (changes != 0) fmt::print("the environment changed\n");
  return costs;
}

struct Spread {
  double least, middle, most;
};

Spread spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values.front(), values[values.size() / 2], values.back()};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_master_overhead PASSTHROUGH.fmu [REPEATS]\n");
    return 2;
  }
  const int repeats = argc > 2 ? std::atoi(argv[2]) : 5;
  try {
    FmuLibrary library;
    const auto path = std::filesystem::absolute(argv[1]);
    const auto fmu = library.open(path);
    fmt::print("{:<22} {:>28} {:>28} {:>12} {:>8}\n", "ns per instance and step", "bare calls min/median/max",
               "master min/median/max", "beyond", "target");
    constexpr Shape kShapes[] = {{"one", 1, 0},
                                 {"chain of four", 4, 3},
                                 {"ring of sixteen", 16, 16},
                                 {"1000 alone", 1000, 0},
                                 {"ring of 1000", 1000, 1000}};
    for (const auto& shape : kShapes) {
      const auto steps = kInstanceSteps / shape.instances;
      std::vector<double> bares;
      std::vector<double> masters;
      for (int repeat = 0; repeat < repeats; ++repeat) {
        bares.push_back(bare(shape, *fmu, steps));
        masters.push_back(by_master(shape, path, library, steps));
      }
      const auto a = spread(bares);
      const auto b = spread(masters);
      const double target = 50 + 10.0 * shape.connections / shape.instances;
      fmt::print("{:<24} {:>26} {:>28} {:>12.1f} {:>8.1f}\n", shape.name,
                 fmt::format("{:.1f} / {:.1f} / {:.1f}", a.least, a.middle, a.most),
                 fmt::format("{:.1f} / {:.1f} / {:.1f}", b.least, b.middle, b.most), b.middle - a.middle, target);
    }
    std::vector<double> watch;
    std::vector<double> whole;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      const auto costs = call_costs(fmu);
      watch.push_back(costs.watched - costs.bare);
      whole.push_back(costs.by_master - costs.bare);
    }
    const auto row = [](const char* what, const Spread& s, const std::string& target) {
      fmt::print("{:<46} {:>28} {:>8}\n", what, fmt::format("{:.1f} / {:.1f} / {:.1f}", s.least, s.middle, s.most),
                 target);
    };
    fmt::print("\n{:<46} {:>28} {:>8}\n", "ns per call beyond the bare one", "min/median/max", "target");
    row("watch over the floating-point environment", spread(watch), "5");
    row("all that the master does around a call", spread(whole), "");
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_master_overhead: %s\n", error.what());
    return 1;
  }
}
