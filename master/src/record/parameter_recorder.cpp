// SPDX-License-Identifier: Apache-2.0
#include "record/recorder.hpp"

#include "mebots/hexadecimal.hpp"
#include "message/message_text.hpp"
#include "model/resolved_system.hpp"
#include "record/sink/csv_sink.hpp"
#include "slave/discrete_link.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

std::string value_text(Slave& slave, const modeldesc::Variable& variable) {
  const auto kind = kind_of(variable.type);  // never a clock, see recorded_parameters()
  const auto value = get_value(slave, kind, variable.value_reference);
  if (const auto* real = std::get_if<double>(&value)) return fmt::format("{}", *real);
  if (const auto* whole = std::get_if<std::int64_t>(&value))
    return whole_text(variable.type, kind == ValueKind::boolean ? std::int64_t{*whole != 0} : *whole);
  const auto& text = std::get<std::string>(value);
  return kind == ValueKind::binary ? hexadecimal(text) : valid_utf8(text);
}

}  // namespace

std::vector<ParameterValue> read_parameters(const ResolvedSystem& system, Ensemble& ensemble) {
  std::vector<ParameterValue> values;
  for (const auto& parameter : recorded_parameters(system)) {
    values.push_back({system.text(parameter), parameter.variable->unit,
                      value_text(ensemble.slave(parameter.instance), *parameter.variable), parameter.variable->type});
  }
  return values;
}

ParameterRecorder::ParameterRecorder(const ResolvedSystem& system, Ensemble& ensemble, std::filesystem::path file)
    : system_(&system), ensemble_(&ensemble), file_(std::move(file)) {}

std::optional<std::string> ParameterRecorder::reached(const Point& point) {
  if (point.step != 0) return std::nullopt;
  std::string text = "parameter,unit,value\n";
  for (const auto& [name, unit, value, type] : read_parameters(*system_, *ensemble_)) {
    text += fmt::format("{},{},{}\n", csv_text(name), csv_text(unit), csv_text(value));
  }
  write_whole(file_, text);
  return std::nullopt;
}

}  // namespace mebots::master
