// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::modeldesc {

/// The base units that an FMI 2.0 <BaseUnit> raises to powers, in the order of Unit::exponents.
inline constexpr std::array<std::string_view, 8> kBaseUnits = {"kg", "m", "s", "A", "K", "mol", "cd", "rad"};

/// Another unit that a tool may show the values in: display = value * factor + offset.
struct DisplayUnit {
  std::string name;
  double factor = 1;
  double offset = 0;
  bool operator==(const DisplayUnit&) const = default;
};

/// A unit by its SI base: value_SI = factor * value + offset, with SI the product of base units to exponents.
struct Unit {
  std::string name;
  bool has_base = true;  // false: the description names the unit without saying what it is
  std::array<int, 8> exponents{};
  double factor = 1;
  double offset = 0;
  std::vector<DisplayUnit> display_units;
  bool operator==(const Unit&) const = default;
};

/// True when both are products of the same base units, so that values can be converted. Units without a
/// base compare by name. `rad` counts as a dimension of its own, as FMI keeps it apart.
bool same_dimension(const Unit& a, const Unit& b);

/// True when a number means the same in both: same dimension, factor (to 1e-12 relative) and offset.
bool same_unit(const Unit& a, const Unit& b);

/// value in `to` = factor * value in `from` + offset; exactly 1 and 0 for the same unit.
struct UnitConversion {
  double factor = 1;
  double offset = 0;
};

/// Between units of the same dimension, both with a base. `difference`: the value is a difference of two (FMI's
/// relativeQuantity), so that offsets fall out.
UnitConversion unit_conversion(const Unit& from, const Unit& to, bool difference);

/// A unit of our own table, with the suffix that C++ names carry.
struct KnownUnit {
  Unit unit;
  std::string suffix;  // `_v` for V; empty for 1
  std::string text;    // "volt"
};

/// The units that a description.json may use, and products of powers of them.
std::span<const KnownUnit> known_units();

/// The unit of a product of powers of known units, in the notation of FMI and Modelica: "m3/s", "rad/(s.V)", "kg.m2",
/// "1/s", "s-1", "1". In a product a unit with an offset, such as degC, counts as a difference. Throws Error
/// (wrong_unit) that says what is wrong, with the nearest known unit.
Unit parse_unit(std::string_view text);

/// The suffix that the C++ name of a variable in this unit carries: "_m3_per_s". Throws as parse_unit does.
std::string unit_suffix(std::string_view text);

/// Exponents as text, "kg.m2/s3"; "1" when all are zero.
std::string base_unit_text(const Unit& unit);

}  // namespace mebots::modeldesc
