// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <span>
#include <string_view>

namespace mebots::master::flight {

/// Reads an airframe: the files of a drone, of its rotors and of its cell, with mass and decks. Returns the content of
/// `file` with absolute paths. Names of shipped files do not change. Throws data::Mistakes with all mistakes of the
/// file.
nlohmann::ordered_json read_airframe(const std::filesystem::path& file);

/// A signal of a flight log that MEbots supports.
struct LogSignal {
  std::string_view name;
  std::string_view unit;
};

/// Returns all supported signals. Valid as long as the program.
std::span<const LogSignal> log_signals();

/// Returns the factor from a log's unit to a signal's unit. Accepts the units of `mebots units`, "g0" (standard
/// gravity) and "1/65535" (a motor value of the Crazyflie's firmware). Throws Error (wrong_unit).
double log_unit_factor(std::string_view from, std::string_view to);

/// Reads a mapping from columns of a log to signals. Returns the content of the mapping. Throws data::Mistakes with all
/// mistakes of the file.
nlohmann::ordered_json read_log_mapping(const std::filesystem::path& file);

}  // namespace mebots::master::flight
