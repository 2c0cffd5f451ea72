// SPDX-License-Identifier: Apache-2.0
#include "bank.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <span>

namespace mebots::bank {

Bank::Bank(const Parameters& parameters)
    : parameters_(parameters), lines_(static_cast<std::size_t>(parameters.lines)), y_m_(parameters.line_initial_m) {}

void Bank::start(const Inputs& inputs, Outputs& outputs) {
  outputs_ = &outputs;
  write(inputs, outputs);
}

void Bank::step(const Inputs& inputs, std::int64_t duration_ns, Outputs& outputs) {
  const double duration_s = static_cast<double>(duration_ns) * 1e-9;
  for (std::size_t i = 0; i < lines_; ++i) {
    if (inputs.line_mode[i] == Mode::integrate) y_m_[i] += inputs.line_u_m_per_s[i] * duration_s;
    const auto message = inputs.line_message[i].bytes();
    echo_[i].assign(message.begin(), message.end());
    bytes_ += static_cast<std::int32_t>(message.size());
  }
  write(inputs, outputs);
}

void Bank::write(const Inputs& inputs, Outputs& outputs) {
  outputs.line_y_m = y_m_;
  std::size_t last = 0;
  for (std::size_t i = 0; i < line::kCount; ++i) {
    outputs.line_moving[i] = i < lines_ && inputs.line_u_m_per_s[i] != 0;
    outputs.line_echo[i] = fmu::BinaryRef::to(echo_[i]);
    last += echo_[i].size();
  }
  outputs.side_bytes = {static_cast<std::int32_t>(last), bytes_};
  outputs.labels = fmt::format("{}", fmt::join(std::span(parameters_.line_label).first(lines_), " "));
}

void Bank::visit(state::Visitor& v) {
  v("y_m", y_m_);
  v("echo", echo_);
  v("bytes", bytes_);
  if (!v.restores() || outputs_ == nullptr) return;
  for (std::size_t i = 0; i < line::kCount; ++i) outputs_->line_echo[i] = fmu::BinaryRef::to(echo_[i]);
}

}  // namespace mebots::bank
