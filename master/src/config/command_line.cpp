// SPDX-License-Identifier: Apache-2.0
#include "config/command_line.hpp"

#include "base/nearest_names.hpp"
#include "base/time.hpp"
#include "config/json_document.hpp"
#include "run/input_hash.hpp"

#include "base/input_text.hpp"
#include "config/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace mebots::master {

void apply_set(SystemDescription& system, const std::string& text) {
  const auto place = fmt::format("--set {}", text);
  const auto equals = text.find('=');
  const auto dot = text.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot == 0 || equals <= dot + 1) {
    throw InputError(fmt::format("{}: write INSTANCE.VARIABLE=VALUE", place));
  }
  const auto target = system.split(text.substr(0, equals))
                          .value_or(VariableName{text.substr(0, dot), text.substr(dot + 1, equals - dot - 1)});
  const auto& name = target.instance;
  const auto found = std::find_if(system.instances.begin(), system.instances.end(),
                                  [&](const InstanceDescription& instance) { return instance.name == name; });
  if (found == system.instances.end()) {
    throw InputError(
        fmt::format("{}: there is no instance '{}'. {}", place, name, suggest(name, system.instance_names())));
  }
  found->parameters.push_back({target.variable, UntypedText{text.substr(equals + 1)}, place});
}

std::string apply_scenario(SystemDescription& system, const std::filesystem::path& file) {
  const auto text = input_text(file);
  const JsonDocument document(text, file.string());
  config::read_scenario_file(document.root(), system);
  return fmt::format("--scenario {} {}", file.filename().string(), sha256(text));
}

std::int64_t read_duration(const std::string& option, const std::string& text) {
  const auto place = fmt::format("{} {}", option, text);
  double seconds = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) {
    throw InputError(fmt::format("{}: this is not a number of seconds", place));
  }
  const auto time_ns = to_nanoseconds(seconds);
  if (!time_ns) {
    throw InputError(
        fmt::format("{}: this is not a whole number of nanoseconds (or longer than {} s)", place, kLongestTimeS));
  }
  if (*time_ns <= 0) throw InputError(fmt::format("{}: this must be a time greater than 0 s", place));
  return *time_ns;
}

void apply_stop_time(SystemDescription& system, const std::string& text) {
  set_stop_time(system, read_duration("--stop-time", text), "--stop-time " + text);
}

}  // namespace mebots::master
