// SPDX-License-Identifier: Apache-2.0
#include "values.hpp"

#include "mebots/input_error.hpp"
#include "model/resolved_system.hpp"
#include "model/value_kind.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace mebots::master::ssp {
namespace {

std::string_view without_brackets(std::string_view name) {
  return name.size() > 2 && name.front() == '[' && name.back() == ']' ? name.substr(1, name.size() - 2) : name;
}

/// Returns the usual definition of a unit that the file does not define. For example, "[mm]" and "mm" are millimetres.
/// Returns nullopt if the name is unknown.
std::optional<modeldesc::Unit> usual(const modeldesc::Unit& unit) {
  if (unit.has_base) return unit;
  try {
    return modeldesc::parse_unit(without_brackets(unit.name));
  } catch (const Error&) {
    return std::nullopt;
  }
}

struct UnitPair {
  std::optional<modeldesc::Unit> from;
  std::optional<modeldesc::Unit> to;
};

/// Finds usual definitions for units that the SSV or the FMU does not define. Without a definition, the value is not
/// converted.
UnitPair defined_units(UnitPair units, const Parameter& parameter, const std::string& name, ValueNotices& notices) {
  if (!units.from || !units.to || (units.from->has_base && units.to->has_base)) return units;
  if (without_brackets(units.from->name) == without_brackets(units.to->name)) return {units.to, units.to};
  const auto from = usual(*units.from);
  const auto to = usual(*units.to);
  const auto which = fmt::format("the units [{}] and [{}] are not both defined", units.from->name, units.to->name);
  if (from && to) {
    notices.add(parameter.file, which + ", so they are read by their usual names", name);
    return {from, to};
  }
  notices.add(parameter.file, which + ", so the numbers are not converted", name);
  return {std::nullopt, units.to};
}

void assign(const Network& network, const Parameter& parameter, const Endpoint& endpoint, ValueNotices& notices,
            std::map<Endpoint, StartingValue>& values) {
  const auto port = network.port(endpoint);
  if (port.variable != nullptr) {
    if (const auto why = why_not_settable(*port.variable); !why.empty()) {
      notices.add(parameter.file, fmt::format("values are ignored, because the variable cannot be set ({})", why),
                  endpoint.text());
      return;
    }
  }
  if (!parameter.problem.empty()) throw InputError(ErrorCode::invalid_value, parameter.problem);
  auto transformation = parameter.transformation;
  if (transformation.place.empty()) transformation.place = parameter.place;
  UnitPair units{parameter.unit, port.unit()};
  if (transformation.convert_units) units = defined_units(units, parameter, endpoint.text(), notices);
  Course course(units.from, port.variable != nullptr && port.variable->relative_quantity);
  course.pass(transformation, units.to);
  const auto name = fmt::format("{}: \"{}\"", parameter.place, parameter.name);
  values.insert_or_assign(endpoint, StartingValue{fitting(course.apply(parameter.value, name), port), course.unit(),
                                                  parameter.file, parameter.place});
}

}  // namespace

void ValueNotices::add(const std::string& file, const std::string& text, const std::string& name) {
  const auto [group, added] = names_.try_emplace({file, text});
  if (added) order_.emplace_back(file, text);
  group->second.push_back(name);
}

std::vector<std::string> ValueNotices::texts() const {
  constexpr std::size_t kShown = 10;
  std::vector<std::string> texts;
  for (const auto& group : order_) {
    const auto& names = names_.at(group);
    const std::span shown(names.data(), std::min(names.size(), kShown));
    const auto more = names.size() - shown.size();
    texts.push_back(fmt::format("{}: {} ({}): {}{}", group.first, group.second, names.size(), fmt::join(shown, ", "),
                                more > 0 ? fmt::format(" and {} more", more) : ""));
  }
  return texts;
}

std::optional<std::int64_t> exact_whole(double number) {
  constexpr double kExact = 9007199254740992.0;  // 2^53
  // The conversion of NaN, or of a number that is too large, would be undefined.
  if (!(std::abs(number) <= kExact) || number != std::floor(number)) return std::nullopt;
  return static_cast<std::int64_t>(number);
}

Json fitting(Json value, const Port& port) {
  if (!value.is_number_float() || port.variable == nullptr) return value;
  if (kind_of(port.variable->type) != ValueKind::integer) return value;
  if (const auto number = exact_whole(value.get<double>())) return *number;
  return value;
}

std::map<Endpoint, StartingValue> starting_values(const Network& network, ValueNotices& notices) {
  std::map<Endpoint, StartingValue> values;
  for (const auto& [path, element] : network.elements()) {  // inner elements precede outer ones
    for (const auto& parameter : element->parameters) {
      const auto found = network.find(path, parameter.name);
      for (const auto& endpoint : found) assign(network, parameter, endpoint, notices, values);
      if (!found.empty()) continue;
      notices.add(parameter.file, "values are ignored, because the system has no such variable",
                  Endpoint{path, parameter.name}.text());
    }
  }
  return values;
}

}  // namespace mebots::master::ssp
