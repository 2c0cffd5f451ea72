// SPDX-License-Identifier: Apache-2.0
// Measures the cost of recording per communication point. Each row has ten Real variables, all 17 digits of which
// change in every row.
//
//     recorder_cost FILE.fmu    (the probe of tests/fmus: build/ci/test_fmus/probe.fmu)
#include "io/config/load_system.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "record/recorder.hpp"
#include "record/sink/csv_sink.hpp"
#include "resolve/resolve.hpp"
#include "run/simulation.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <fstream>

namespace {

using namespace mebots::master;

std::string fmu;

class Silent final : public MessageSink {
 public:
  void message(const mebots::Message& /*message*/) override {}
};

/// Simulates five instances in a ring. Their values never repeat.
class Ring {
 public:
  Ring() {
    std::string instances;
    std::string connections;
    for (int i = 0; i < 5; ++i) {
      instances += fmt::format(R"({}"i{}": {{"fmu": "{}", "parameters": {{"gain": -0.9, "offset": {}}}}})",
                               i == 0 ? "" : ", ", i, fmu, 0.3 + i);
      connections +=
          fmt::format(R"({}{{"from": "i{}.real_out", "to": "i{}.real_in"}})", i == 0 ? "" : ", ", i, (i + 1) % 5);
    }
    const auto config = folder_.path() / "ring.json";
    std::ofstream(config) << fmt::format(
        R"({{"step": 0.001, "stop_time": 1000000, "instances": {{{}}}, "connections": [{}], "record": ["*.real_out", "*.integral"]}})",
        instances, connections);
    description_ = read_config(config);
    system_ = resolve(description_, library_);
    simulation_.emplace(system_, silent_);
  }

  Simulation& simulation() { return *simulation_; }
  const ResolvedSystem& system() const { return system_; }
  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  mebots::modeldesc::TemporaryFolder folder_{"mebots-bench"};
  Silent silent_;
  FmuLibrary library_;
  SystemDescription description_;
  ResolvedSystem system_;
  std::optional<Simulation> simulation_;
};

void steps(benchmark::State& state) {
  Ring ring;
  const Recorder watched(ring.system(), ring.simulation().ensemble());  // reads the same values
  ring.simulation().initialize();
  for ([[maybe_unused]] auto _ : state) ring.simulation().step();
}

/// Measures steps with recording to results.csv. The difference from `steps` is the cost of recording.
void steps_with_csv(benchmark::State& state) {
  Ring ring;
  OutputFile file(ring.folder() / "results.csv");
  Recorder recorder(ring.system(), ring.simulation().ensemble());
  recorder.add(std::make_unique<CsvSink>(recorder.columns(), file));
  ring.simulation().add(recorder);
  ring.simulation().initialize();
  for ([[maybe_unused]] auto _ : state) ring.simulation().step();
  recorder.flush();
}

/// Measures the time that the recorder needs on the simulation's thread for a row of ten values.
void rows(benchmark::State& state) {
  Ring ring;
  OutputFile file("/dev/null");
  Recorder recorder(ring.system(), ring.simulation().ensemble());
  recorder.add(std::make_unique<CsvSink>(recorder.columns(), file));
  ring.simulation().initialize();
  for (int i = 0; i < 1000; ++i) ring.simulation().step();
  std::int64_t step = 0;
  for ([[maybe_unused]] auto _ : state) {
    recorder.reached({step, step * 1'000'000});
    ++step;
  }
}

BENCHMARK(steps);
BENCHMARK(steps_with_csv);
BENCHMARK(rows);

}  // namespace

int main(int argument_count, char** arguments) {
  benchmark::Initialize(&argument_count, arguments);
  if (argument_count != 2) {
    fmt::print(stderr, "recorder_cost: name the probe FMU\n");
    return 2;
  }
  fmu = std::filesystem::absolute(arguments[1]).string();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
