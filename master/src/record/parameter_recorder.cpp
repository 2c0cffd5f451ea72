// SPDX-License-Identifier: Apache-2.0
#include "record/recorder.hpp"

#include "mebots/hexadecimal.hpp"
#include "message/message_text.hpp"
#include "model/resolved_system.hpp"
#include "record/sink/csv_sink.hpp"

#include <fmt/format.h>

#include <span>

namespace mebots::master {
namespace {

template <typename T, typename Get>
T one(Get get, ValueReference reference) {
  T value{};
  get(std::span(&reference, 1), std::span(&value, 1));
  return value;
}

std::string value_text(Slave& slave, const modeldesc::Variable& variable) {
  const auto reference = variable.value_reference;
  switch (kind_of(variable.type)) {
    case ValueKind::real:
      return fmt::format("{}", one<double>([&](auto r, auto v) { slave.get_reals(r, v); }, reference));
    case ValueKind::integer:
      return whole_text(variable.type, one<std::int64_t>([&](auto r, auto v) { slave.get_integers(r, v); }, reference));
    case ValueKind::boolean:
      return one<std::int64_t>([&](auto r, auto v) { slave.get_booleans(r, v); }, reference) == 0 ? "0" : "1";
    case ValueKind::binary:
      return hexadecimal(one<std::string>([&](auto r, auto v) { slave.get_binaries(r, v); }, reference));
    case ValueKind::clock:  // recorded_parameters() returns no clocks
    case ValueKind::string:
      break;
  }
  return valid_utf8(one<std::string>([&](auto r, auto v) { slave.get_strings(r, v); }, reference));
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
