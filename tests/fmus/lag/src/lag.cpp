// SPDX-License-Identifier: Apache-2.0
#include "lag.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <fstream>
#include <numeric>
#include <span>
#include <stdexcept>

namespace mebots::lag {

Lag::Lag(Variables& variables, const std::filesystem::path& resources)
    : variables_(variables), y_v_(variables.parameters.channel_initial_v) {
  const auto file = resources / variables.parameters.label_file;
  std::ifstream stream(file);
  if (!std::getline(stream, label_)) throw Error(fmt::format("label.file: {} cannot be read", file.string()));
  write_outputs();
}

void Lag::step(std::int64_t duration_ns) {
  const auto& [parameters, inputs, outputs] = variables_;
  if (inputs.trouble == Trouble::mendable) throw Error("trouble is mendable: 100 % as asked; set it to none");
  if (inputs.trouble == Trouble::fatal) throw std::runtime_error("trouble is fatal, as asked");
  const double duration_s = static_cast<double>(duration_ns) * 1e-9;
  for (std::size_t i = 0; inputs.enabled && i < channel::kCount; ++i) {
    const double target_v = parameters.gain * inputs.channel_u_v[i];
    y_v_[i] = target_v + (y_v_[i] - target_v) * std::exp(-duration_s / parameters.channel_time_constant_s[i]);
  }
  const std::vector<std::uint8_t>& before = history();
  ++steps_;
  history() = before;
  history().push_back(static_cast<std::uint8_t>(steps_));
  write_outputs();
}

void Lag::write_outputs() {
  const auto& inputs = variables_.inputs;
  auto& outputs = variables_.outputs;
  outputs.channel_y_v = y_v_;
  outputs.steps = steps_;
  outputs.trouble_seen = inputs.trouble;
  outputs.moving = inputs.enabled && y_v_ != inputs.channel_u_v;
  const auto message = inputs.message.bytes();
  outputs.message_sum = std::accumulate(message.begin(), message.end(), std::int32_t{0});
  outputs.label = inputs.note.empty() ? label_ : label_ + ": " + inputs.note;
  outputs.history = fmu::BinaryRef::to(history());
}

void Lag::visit(state::Visitor& v) {
  v("y_v", y_v_);
  v("steps", steps_);
  v("history", history());
  if (v.restores()) variables_.outputs.history = fmu::BinaryRef::to(history());
}

std::string Lag::history_text() const {
  return fmt::format("{}", fmt::join(history(), " "));
}

}  // namespace mebots::lag
