// SPDX-License-Identifier: Apache-2.0
#include "io/config/command_line.hpp"

#include "base/time.hpp"
#include "mebots/input_error.hpp"
#include "mebots/parsed_number.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

struct TypedTime {
  WrittenTime written;
  ExactTime exact;
};

TypedTime read_typed(const std::string& option, const std::string& text) {
  const auto place = fmt::format("{} {}", option, text);
  if (const auto ratio = read_ratio(text)) return {text, *ratio};
  const auto seconds = parsed_number<double>(text);
  if (!seconds) {
    throw InputError(ErrorCode::syntax_error,
                     fmt::format("{}: this is neither a number of seconds nor a ratio such as 1/60", place));
  }
  const auto time = exact_time(*seconds);
  if (!time) {
    throw InputError(
        ErrorCode::value_out_of_range,
        fmt::format(
            "{}: this is not a whole number of nanoseconds, or it is longer than {} s; a ratio such as 1/60 is allowed",
            place, kLongestTimeS));
  }
  return {*seconds, *time};
}

TypedTime read_above_zero(const std::string& option, const std::string& text) {
  auto time = read_typed(option, text);
  if (time.exact.numerator > 0) return time;
  throw InputError(ErrorCode::value_out_of_range,
                   fmt::format("{} {}: this must be a time greater than 0 s", option, text));
}

}  // namespace

Setting read_set(const std::string& text) {
  auto place = fmt::format("--set {}", text);
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError(ErrorCode::syntax_error, fmt::format("{}: write INSTANCE.VARIABLE=VALUE", place));
  }
  return {text.substr(0, equals), UntypedText{text.substr(equals + 1)}, std::move(place)};
}

Setting with_longest_name(const Setting& setting, const std::function<bool(const std::string&)>& is_known) {
  const auto* value = std::get_if<UntypedText>(&setting.value);
  if (value == nullptr) return setting;
  const auto text = setting.variable + "=" + value->text;
  for (auto equals = text.rfind('='); equals > setting.variable.size(); equals = text.rfind('=', equals - 1)) {
    auto name = text.substr(0, equals);
    if (is_known(name)) return {std::move(name), UntypedText{text.substr(equals + 1)}, setting.place};
  }
  return setting;
}

std::vector<std::string> with_each_set(const std::vector<std::string>& arguments) {
  std::vector<std::string> result;
  bool in_set = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const auto& argument = arguments[i];
    const bool is_option = argument.starts_with('-');
    if (in_set && !is_option && argument.find('=') != std::string::npos) {
      result.emplace_back("--set");
    } else if (is_option) {
      in_set = argument == "--set" || argument.starts_with("--set=");
    }
    result.push_back(argument);
    if (argument == "--set" && i + 1 < arguments.size()) result.push_back(arguments[++i]);
  }
  return result;
}

std::int64_t read_duration(const std::string& option, const std::string& text) {
  return to_nanoseconds(read_above_zero(option, text).exact);
}

std::int64_t read_time(const std::string& option, const std::string& text) {
  return to_nanoseconds(read_typed(option, text).exact);
}

WrittenTime read_step(const std::string& option, const std::string& text) {
  return read_above_zero(option, text).written;
}

}  // namespace mebots::master
