// SPDX-License-Identifier: Apache-2.0
#include "io/signal_file.hpp"

#include "base/input_text.hpp"
#include "base/time.hpp"
#include "mebots/modeldesc/units.hpp"
#include "mebots/nearest_names.hpp"
#include "mebots/parsed_number.hpp"
#include "model/resolved_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mebots::master {
namespace {

using data::CsvReader;
using modeldesc::Type;
using modeldesc::Variability;

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return result;
}

double real_cell(const CsvReader& reader, const WantedSignal& wanted) {
  const double value = wanted.factor * reader.number(wanted.column) + wanted.offset;
  const auto refuse = [&](std::string_view side, double limit) {
    reader.fail(wanted.column, ErrorCode::value_out_of_range,
                fmt::format("{} is {} {} of '{}'", value, side, limit, wanted.variable->name));
  };
  if (!std::isfinite(value)) {
    reader.fail(wanted.column, ErrorCode::not_finite, fmt::format("the value becomes {} in another unit", value));
  }
  if (wanted.variable->min && value < *wanted.variable->min) refuse("below the minimum", *wanted.variable->min);
  if (wanted.variable->max && value > *wanted.variable->max) refuse("above the maximum", *wanted.variable->max);
  return value;
}

/// Converts a cell to a value of a config. Accepts 3.0 for the whole number 3, and TRUE for true, because spreadsheets
/// write them.
WrittenValue as_written(std::string_view cell, Type type) {
  if (type == Type::string || type == Type::binary) return std::string(cell);
  const auto text = data::trimmed(cell);
  if (type == Type::boolean) {
    const auto word = lower(text);
    if (word == "true" || word == "false") return word == "true";
  }
  if (fmi::is_whole(type)) {
    if (const auto whole = parsed_number<std::int64_t>(text)) return *whole;
  }
  const auto number = parsed_number<double>(text);
  constexpr double kMostWhole = 1e15;
  if (!number || std::floor(*number) != *number || std::abs(*number) > kMostWhole) {
    return UntypedText{std::string(text)};
  }
  if (type == Type::boolean && (*number == 0 || *number == 1)) return *number == 1;
  return static_cast<std::int64_t>(*number);
}

/// Reads an Integer, an enumeration item, a Boolean or a text like a value of a config.
modeldesc::Value other_cell(const CsvReader& reader, const WantedSignal& wanted) {
  const auto cell = reader.cell(wanted.column);
  const auto type = wanted.variable->type;
  if (type != Type::string && type != Type::binary && data::trimmed(cell).empty()) {
    reader.fail(wanted.column, ErrorCode::wrong_type, "the cell is empty; a value is needed");
  }
  try {
    return typed_value(*wanted.model, *wanted.variable, as_written(cell, type), "value");
  } catch (const InputError& error) {
    reader.fail(wanted.column, error.code(), error.what());
  }
}

Signal::Values no_values(Type type) {
  if (fmi::is_float(type)) return std::vector<double>();
  if (type == Type::string || type == Type::binary) return std::vector<std::string>();
  return std::vector<std::int64_t>();
}

void append(Signal::Values& values, const CsvReader& reader, const WantedSignal& wanted) {
  if (auto* reals = std::get_if<std::vector<double>>(&values)) {
    reals->push_back(real_cell(reader, wanted));
    return;
  }
  auto value = other_cell(reader, wanted);
  if (auto* texts = std::get_if<std::vector<std::string>>(&values)) {
    texts->push_back(std::get<std::string>(std::move(value)));
    return;
  }
  const auto* flag = std::get_if<bool>(&value);
  std::get<std::vector<std::int64_t>>(values).push_back(flag != nullptr ? (*flag ? 1 : 0)
                                                                        : std::get<std::int64_t>(value));
}

}  // namespace

SignalFile::SignalFile(const std::filesystem::path& file, std::string name, const std::string& time_column)
    : text_(input_text(file)), reader_(refused_as_input([&] { return CsvReader(text_, std::move(name)); })) {
  for (const auto& title : reader_.header()) titles_.push_back(data::csv_title(title));
  refused_as_input([&] {
    time_column_ = find_time(time_column);
    find_time_unit();
  });
}

std::optional<std::size_t> SignalFile::find(std::string_view title) const {
  if (const auto column = reader_.column(title)) return column;
  const auto found = std::ranges::find(titles_, title, &data::CsvTitle::name);
  if (found == titles_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - titles_.begin());
}

std::size_t SignalFile::find_time(const std::string& wanted) const {
  if (!wanted.empty()) {
    if (const auto column = find(wanted)) return *column;
    throw InputError(ErrorCode::unknown_name, fmt::format("{}: there is no column '{}' with the times. {}", name(),
                                                          wanted, suggest(wanted, reader_.header())));
  }
  const auto found = std::ranges::find_if(titles_, [](const data::CsvTitle& title) {
    const auto word = lower(title.name);
    return word == "time" || word == "t";
  });
  if (found != titles_.end()) return static_cast<std::size_t>(found - titles_.begin());
  throw InputError(ErrorCode::missing_key,
                   fmt::format("{}: there is no column of times. Name it 'time', or give its name as \"time\" in the "
                               "config. {}",
                               name(), suggest("time", reader_.header())));
}

void SignalFile::find_time_unit() {
  const auto& unit = titles_[time_column_].unit;
  if (unit.empty()) return;
  const auto found = modeldesc::parse_unit(unit);
  const auto seconds = modeldesc::parse_unit("s");
  if (!modeldesc::same_dimension(found, seconds)) {
    throw InputError(ErrorCode::wrong_unit,
                     fmt::format("{}: the column of times is in [{}], which is not a unit of time", name(), unit));
  }
  second_ = modeldesc::unit_conversion(found, seconds, false).factor;
}

void SignalFile::read_time(std::vector<double>& times_s) {
  const double time_s = second_ * reader_.number(time_column_);
  const auto fail = [&](ErrorCode code, const std::string& what) { reader_.fail(time_column_, code, what); };
  if (std::abs(time_s) > kLongestTimeS) {
    fail(ErrorCode::value_out_of_range, fmt::format("{} s is longer than {} s", time_s, kLongestTimeS));
  }
  if (!times_s.empty() && time_s < times_s.back()) {
    fail(ErrorCode::invalid_value, fmt::format("{} s follows {} s; times must not decrease", time_s, times_s.back()));
  }
  times_s.push_back(time_s);
  if (times_s.size() < 3) return;
  const auto ns = [&](std::size_t back) { return std::llround(times_s[times_s.size() - back] * 1e9); };
  if (ns(1) == ns(3)) {
    fail(ErrorCode::invalid_value, fmt::format("this is the third row at {} s; at most two rows may have the same "
                                               "time: the values before and after a jump",
                                               time_s));
  }
}

std::vector<std::shared_ptr<const Signal>> SignalFile::read(std::span<const WantedSignal> wanted) {
  std::vector<double> times_s;
  std::vector<Signal::Values> values;
  for (const auto& one : wanted) values.push_back(no_values(one.variable->type));
  refused_as_input([&] {
    while (reader_.next()) {
      read_time(times_s);
      for (std::size_t i = 0; i < wanted.size(); ++i) append(values[i], reader_, wanted[i]);
    }
  });
  if (times_s.empty()) {
    throw InputError(ErrorCode::syntax_error, fmt::format("{}: the file has a header and no rows", name()));
  }
  const auto times = std::make_shared<const SignalTimes>(std::move(times_s));
  std::vector<std::shared_ptr<const Signal>> signals;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto& variable = *wanted[i].variable;
    const bool linear = fmi::is_float(variable.type) && variable.variability == Variability::continuous;
    signals.push_back(std::make_shared<const Signal>(times, std::move(values[i]), linear));
  }
  return signals;
}

}  // namespace mebots::master
