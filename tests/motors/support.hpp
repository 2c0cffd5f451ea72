// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/difference.hpp"
#include "model.hpp"
#include "support/bench.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mebots::motors {

using test::error_of;
using test::kMillisecond;
using test::kParams;

inline std::filesystem::path rotor_file(const std::string& name) {
  return kParams / "rotors" / (name + ".json");
}
inline RotorData bench_rotor() {
  return load_rotor(rotor_file("crazyflie_bench"));
}

inline nlohmann::json read_json(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return nlohmann::json::parse(stream);
}

struct BenchRow {
  double current_a;
  double thrust_n;  // of one rotor
  double voltage_v;
  double command;
  double speed_rad_per_s;
};

/// Returns the rows of the bench table that the rotor file quotes, in SI units.
inline std::vector<BenchRow> bench_rows() {
  std::vector<BenchRow> rows;
  const auto json = read_json(rotor_file("crazyflie_bench"));
  for (const auto& row : json["bench"]["rows"]) {
    rows.push_back({row[0], row[1].get<double>() * 9.80665e-3 / 4, row[2], row[3].get<double>() / 100,
                    row[4].get<double>() * 2 * 3.14159265358979 / 60});
  }
  return rows;
}

/// Only the file of this rotor contains a bench table.
inline Parameters bench_parameters() {
  Parameters parameters;
  parameters.rotor_data = "crazyflie_bench";
  return parameters;
}

/// Connects a model to its variables, as fmu.cpp does.
struct Stand {
  explicit Stand(const Parameters& parameters = bench_parameters()) : model(parameters, kParams) {
    model.start(inputs, outputs);
  }

  void command(double value) { inputs.rotor_command.fill(value); }
  void step(std::int64_t duration_ns) { model.step(inputs, duration_ns, outputs); }
  void settle() {
    for (int i = 0; i < 2000; ++i) step(2 * kMillisecond);
  }

  Inputs inputs;
  Outputs outputs;
  Model model;
};

}  // namespace mebots::motors
