// SPDX-License-Identifier: Apache-2.0
#include "mebots/data/estimate.hpp"

#include <fmt/format.h>

namespace mebots::data {
namespace {

void read_interval(Object& object, Estimate& estimate, const Limits& limits) {
  object.visit_if("interval", [&](const Node& node) {
    const auto ends = read_numbers(node, limits);
    if (ends.size() != 2) node.fail(ErrorCode::invalid_value, "two numbers are needed: the lower and the upper end");
    if (!(ends[0] <= estimate.value && estimate.value <= ends[1])) {
      node.fail(ErrorCode::invalid_value,
                fmt::format("the interval from {} to {} must contain the value, {}", ends[0], ends[1], estimate.value));
    }
    estimate.interval = {ends[0], ends[1]};
  });
}

}  // namespace

double Estimate::at(double position) const {
  if (!interval || position == 0) return value;
  return position < 0 ? value + position * (value - interval->least) : value + position * (interval->most - value);
}

Estimate read_estimate(const Node& node, std::string_view unit, const Limits& limits) {
  Object object(node);
  Estimate estimate;
  const bool known = object.read("value", estimate.value, number(limits));
  read_unit(object, unit);
  read_source(object);
  object.comment("fitted_on");
  if (known) {
    read_interval(object, estimate, limits);
  } else {
    object.allow({"interval"});
  }
  object.finish();
  return estimate;
}

double Placement::value(const Estimate& estimate, double position, std::string_view quantity,
                        std::string_view parameter) const {
  if (!Limits::between(-1, 1).admit(position)) {
    throw Error(
        fmt::format("{} = {} must be >= -1 and <= 1: the position in the interval of {}, from its lower to its "
                    "upper end; 0 is the value",
                    parameter, position, quantity));
  }
  if (position != 0 && !estimate.interval)
    warnings_->push_back(fmt::format("{} has no effect: {} has no interval of {}", parameter, file_, quantity));
  return estimate.at(position);
}

}  // namespace mebots::data
