// SPDX-License-Identifier: Apache-2.0
#include "converter.hpp"

#include "mebots/data_file.hpp"

#include <algorithm>

namespace mebots::battery {

Converter::Converter(std::string name, double output_voltage_v, std::vector<double> output_current_a,
                     std::vector<double> efficiency)
    : name_(std::move(name)),
      output_voltage_v_(output_voltage_v),
      output_current_a_(std::move(output_current_a)),
      efficiency_(std::move(efficiency)) {}

double Converter::efficiency(double output_power_w) const {
  if (output_current_a_.empty()) return 1;
  const double current_a = output_power_w / output_voltage_v_;
  if (current_a <= output_current_a_.front()) return efficiency_.front();
  if (current_a >= output_current_a_.back()) return efficiency_.back();
  const auto above = std::upper_bound(output_current_a_.begin(), output_current_a_.end(), current_a);
  const auto i = static_cast<std::size_t>(above - output_current_a_.begin());
  const double weight = (current_a - output_current_a_[i - 1]) / (output_current_a_[i] - output_current_a_[i - 1]);
  return efficiency_[i - 1] + weight * (efficiency_[i] - efficiency_[i - 1]);
}

double Converter::output_power_w(double input_power_w) const {
  if (output_current_a_.empty() || input_power_w <= 0) return input_power_w;
  // input_power_w() rises with the output (load_converter makes sure), so halving the bracket always works.
  // It ends when the bracket is two neighbouring doubles.
  double low = 0;
  double high = input_power_w;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return high;
    (this->input_power_w(middle) < input_power_w ? low : high) = middle;
  }
}

Converter load_converter(const std::filesystem::path& file, const std::string& name, const std::string& variable) {
  const data::File json(file);
  const data::Node root = json.root();
  if (!root.has(name)) {
    throw Error(fmt::format("{} = \"{}\": {} knows no such converter; take one of {}", variable, name, file.string(),
                            fmt::join(root.keys(), ", ")));
  }
  const data::Node node = root.object(name);
  node.only({"notes", "source", "output_voltage", "output_current", "efficiency"});
  if (node.text("source").empty()) node.fail("source", "is empty: say where the values come from");
  using data::Limits;
  if (!node.has("output_current")) {
    if (node.number("efficiency", Limits::between(1, 1)) == 1) return {};
  }
  const double voltage_v = node.quantity("output_voltage", "V", Limits::positive());
  const data::Node current = node.object("output_current");
  current.only({"unit", "value"}).require_unit("A");
  auto current_a = current.rising_numbers("value", Limits::at_least(0));
  const data::Node efficiency_node = node.object("efficiency");
  efficiency_node.only({"unit", "value"}).require_unit("1");
  auto efficiency = efficiency_node.numbers("value", {0, 1, false});
  if (efficiency.size() != current_a.size()) {
    efficiency_node.fail("value",
                         fmt::format("has {} entries but output_current has {}", efficiency.size(), current_a.size()));
  }
  for (std::size_t i = 1; i < current_a.size(); ++i) {
    // More output must need more input, otherwise the converter cannot be read backwards. On a segment the
    // input I / eta(I) with linear eta = a + b I has the sign of a as its slope, so the ends decide.
    const double slope = (efficiency[i] - efficiency[i - 1]) / (current_a[i] - current_a[i - 1]);
    if (efficiency[i] - slope * current_a[i] <= 0) {
      efficiency_node.fail(fmt::format("value[{}]", i), "rises so fast that more output would need less input");
    }
  }
  return {name, voltage_v, std::move(current_a), std::move(efficiency)};
}

}  // namespace mebots::battery
