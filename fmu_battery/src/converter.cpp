// SPDX-License-Identifier: Apache-2.0
#include "converter.hpp"

#include "mebots/assert.hpp"
#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace mebots::battery {
namespace {

/// Returns a function that reads an object {"unit", "value": [...]} and returns its list of numbers.
auto table(std::string_view unit, std::vector<double> (*read)(const data::Node&, const data::Limits&),
           const data::Limits& limits) {
  return [=](const data::Node& node) {
    data::Object object(node);
    std::vector<double> values;
    data::read_unit(object, unit);
    object.read("value", values, [&](const data::Node& list) { return read(list, limits); });
    object.finish();
    return values;
  };
}

/// Checks that the input power rises with the output power, so that output_power_w() is unique. On a segment with
/// linear eta = a + b I, the slope of the input I / eta(I) has the sign of a, so that one check per segment is
/// sufficient.
void check_rising_input(const data::Node& efficiencies, const std::vector<double>& current_a,
                        const std::vector<double>& efficiency) {
  for (std::size_t i = 1; i < current_a.size(); ++i) {
    const double slope = (efficiency[i] - efficiency[i - 1]) / (current_a[i] - current_a[i - 1]);
    if (efficiency[i] - slope * current_a[i] > 0) continue;
    efficiencies.elements()[i].complain(
        ErrorCode::invalid_value, "the efficiency rises so steeply that a larger output would need a smaller input");
  }
}

Converter read_converter(const std::string& name, const data::Node& node) {
  using data::Limits;
  data::Object object(node);
  object.comment("notes");
  data::read_source(object);
  if (!object.has("output_current")) {
    double one = 1;
    object.read("efficiency", one, data::number(Limits::between(1, 1)));
    object.allow({"output_voltage", "output_current"});
    object.finish();
    return {};
  }
  double voltage_v = 1;
  std::vector<double> current_a;
  std::vector<double> efficiency;
  object.read("output_voltage", voltage_v, data::quantity("V", Limits::positive()));
  object.read("output_current", current_a, table("A", &data::read_rising_numbers, Limits::at_least(0)));
  object.read("efficiency", efficiency, table("1", &data::read_numbers, {0, 1, false}));
  object.finish();
  if (!object.sound()) return {};
  const auto efficiencies = node.at("efficiency").at("value");
  if (efficiency.size() != current_a.size()) {
    efficiencies.fail(ErrorCode::invalid_value, fmt::format("there are {} entries here, but {} in output_current",
                                                            efficiency.size(), current_a.size()));
  }
  check_rising_input(efficiencies, current_a, efficiency);
  return {name, voltage_v, std::move(current_a), std::move(efficiency)};
}

}  // namespace

Converter::Converter(std::string name, double output_voltage_v, std::vector<double> output_current_a,
                     std::vector<double> efficiency)
    : name_(std::move(name)),
      output_voltage_v_(output_voltage_v),
      output_current_a_(std::move(output_current_a)),
      efficiency_(std::move(efficiency)) {}

double Converter::efficiency(double output_power_w) const {
  if (output_current_a_.empty()) return 1;
  const double current_a = output_power_w / output_voltage_v_;
  MEBOTS_ASSERT(output_voltage_v_ > 0 && efficiency_.size() == output_current_a_.size());
  if (current_a <= output_current_a_.front()) return efficiency_.front();
  if (current_a >= output_current_a_.back()) return efficiency_.back();
  const auto above = std::upper_bound(output_current_a_.begin(), output_current_a_.end(), current_a);
  const auto i = static_cast<std::size_t>(above - output_current_a_.begin());
  MEBOTS_ASSERT(i > 0 && i < output_current_a_.size(), "between the ends, seen above");
  const double weight = (current_a - output_current_a_[i - 1]) / (output_current_a_[i] - output_current_a_[i - 1]);
  return efficiency_[i - 1] + weight * (efficiency_[i] - efficiency_[i - 1]);
}

double Converter::output_power_w(double input_power_w) const {
  if (output_current_a_.empty() || input_power_w <= 0) return input_power_w;
  // Bisects until the bracket is two neighbouring doubles. load_converter() has checked that the input power rises with
  // the output power.
  double low = 0;
  double high = input_power_w;
  for (;;) {
    MEBOTS_ASSERT(low < high);
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return high;
    (this->input_power_w(middle) < input_power_w ? low : high) = middle;
  }
}

std::map<std::string, Converter> load_converters(const std::filesystem::path& file) {
  return data::Document(file).read([](const data::Node& root) {
    std::map<std::string, Converter> converters;
    for (const auto& member : root.members()) {
      member.value.attempt([&] {
        if (member.key == "$schema") {
          static_cast<void>(member.value.text());
        } else {
          converters.emplace(member.key, read_converter(member.key, member.value));
        }
      });
    }
    return converters;
  });
}

Converter load_converter(const std::filesystem::path& file, const std::string& name, const std::string& variable) {
  const auto converters = load_converters(file);
  if (const auto found = converters.find(name); found != converters.end()) return found->second;
  std::vector<std::string> known;
  known.reserve(converters.size());
  for (const auto& [other, converter] : converters) known.push_back(other);
  throw Error(ErrorCode::unknown_name, fmt::format("{} = \"{}\": {} has no converter of this name. {}", variable, name,
                                                   file.string(), suggest(name, known)));
}

}  // namespace mebots::battery
