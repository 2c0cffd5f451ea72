// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/difference.hpp"
#include "model.hpp"
#include "support/bench.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace mebots::battery {

using test::error_of;
using test::kMillisecond;
using test::kParams;
constexpr std::int64_t kSecond = 1'000'000'000;

inline Cell cell_named(const std::string& name) {
  return load_cell(kParams / "cells" / (name + ".json"));
}

struct Bench {
  explicit Bench(const Parameters& chosen = {}, const Inputs& at_start = {})
      : parameters(chosen),
        inputs(at_start),
        model(parameters, kParams, [this](Model::Message kind, std::string_view text) {
          events.emplace_back(text);
          if (kind == Model::Message::warning) warnings.emplace_back(text);
        }) {
    model.start(inputs, 0, outputs);
  }

  void step(std::int64_t duration_ns) {
    model.step(inputs, now_ns, duration_ns, outputs);
    now_ns += duration_ns;
  }

  Parameters parameters;
  Inputs inputs;
  Outputs outputs;
  std::vector<std::string> events;    // all messages
  std::vector<std::string> warnings;  // those that need an action
  Model model;
  std::int64_t now_ns = 0;
};

inline Parameters parameters(const std::string& cell, double soc) {
  Parameters made;
  made.cell_name = cell;
  made.cell_initial_state_of_charge = soc;
  return made;
}

/// Returns the allocations on this thread since the start of the program; -1 if a sanitizer replaces malloc.
long allocations();

}  // namespace mebots::battery
