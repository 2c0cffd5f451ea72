// SPDX-License-Identifier: Apache-2.0
#include "config/command_line.hpp"

#include "base/time.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <charconv>

namespace mebots::master {

Setting read_set(const std::string& text) {
  auto place = fmt::format("--set {}", text);
  const auto equals = text.find('=');
  const auto dot = text.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot == 0 || equals <= dot + 1) {
    throw InputError(ErrorCode::syntax_error, fmt::format("{}: write INSTANCE.VARIABLE=VALUE", place));
  }
  return {text.substr(0, equals), UntypedText{text.substr(equals + 1)}, std::move(place)};
}

std::int64_t read_duration(const std::string& option, const std::string& text) {
  const auto place = fmt::format("{} {}", option, text);
  double seconds = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) {
    throw InputError(ErrorCode::syntax_error, fmt::format("{}: this is not a number of seconds", place));
  }
  const auto time_ns = to_nanoseconds(seconds);
  if (!time_ns) {
    throw InputError(
        ErrorCode::value_out_of_range,
        fmt::format("{}: this is not a whole number of nanoseconds (or longer than {} s)", place, kLongestTimeS));
  }
  if (*time_ns <= 0)
    throw InputError(ErrorCode::value_out_of_range, fmt::format("{}: this must be a time greater than 0 s", place));
  return *time_ns;
}

}  // namespace mebots::master
