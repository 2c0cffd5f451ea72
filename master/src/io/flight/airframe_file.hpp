// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <span>
#include <string_view>

namespace mebots::master::flight {

/// Reads an airframe file and its referenced files: drone, rotors and cell, with mass and decks. Returns the content of
/// `file` with absolute paths. Does not change the names of shipped files. Throws data::Mistakes with all mistakes.
nlohmann::ordered_json read_airframe(const std::filesystem::path& file);

/// A signal of a flight log that MEbots supports.
struct LogSignal {
  std::string_view name;
  std::string_view unit;
};

/// Returns all supported signals. They are valid until the program ends.
std::span<const LogSignal> log_signals();

/// Returns the factor from the unit of a log to the unit of a signal. Accepts the units of `mebots units`, "g0"
/// (standard gravity) and "1/65535" (a motor value in the firmware of the Crazyflie). Throws Error (wrong_unit) for all
/// other units.
double log_unit_factor(std::string_view from, std::string_view to);

/// Reads a file that maps columns of a log to signals, and returns its content. Throws data::Mistakes with all
/// mistakes.
nlohmann::ordered_json read_log_mapping(const std::filesystem::path& file);

}  // namespace mebots::master::flight
