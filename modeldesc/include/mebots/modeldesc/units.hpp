// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::modeldesc {

/// The base units of FMI 2.0's <BaseUnit>, in the order of Unit::exponents.
inline constexpr std::array<std::string_view, 8> kBaseUnits = {"kg", "m", "s", "A", "K", "mol", "cd", "rad"};

/// A further unit in which a tool may show values: displayed value = value * factor + offset.
struct DisplayUnit {
  std::string name;
  double factor = 1;
  double offset = 0;
  bool operator==(const DisplayUnit&) const = default;
};

/// Defines a unit in terms of SI base units: value_SI = factor * value + offset. The SI unit is the product of the base
/// units, each raised to its exponent.
struct Unit {
  std::string name;
  bool has_base = true;  // false: the description names the unit but does not define it
  std::array<int, 8> exponents{};
  double factor = 1;
  double offset = 0;
  std::vector<DisplayUnit> display_units;
  bool operator==(const Unit&) const = default;
};

/// Returns true if both units have the same exponents, so that values can be converted. Units without a definition are
/// compared by name. `rad` is a separate dimension, as in FMI.
bool same_dimension(const Unit& a, const Unit& b);

/// Returns true if a number has the same meaning in both units. This requires the same dimension, factor (to 1e-12
/// relative) and offset.
bool same_unit(const Unit& a, const Unit& b);

/// The conversion between two units: value in `to` = factor * value in `from` + offset. For equal units, the factor is
/// exactly 1 and the offset exactly 0.
struct UnitConversion {
  double factor = 1;
  double offset = 0;
};

/// Returns the conversion between two defined units of the same dimension. If `difference` is true, the values are
/// differences (FMI's relativeQuantity), and the offset is 0.
UnitConversion unit_conversion(const Unit& from, const Unit& to, bool difference);

struct KnownUnit {
  Unit unit;
  std::string suffix;  // suffix of C++ names: `_v` for V; empty for 1
  std::string text;    // name in words: "volt"
};

/// Returns the units that a description.json may use, alone or in products of their powers.
std::span<const KnownUnit> known_units();

/// Parses a product of powers of known units in the notation of FMI and Modelica: "m3/s", "rad/(s.V)", "kg.m2", "1/s",
/// "s-1", "1". In a product, a unit with an offset, such as degC, means a difference. Throws Error (wrong_unit) with
/// the fault. If a unit is unknown, the error suggests the nearest known units.
Unit parse_unit(std::string_view text);

/// Returns the suffix of C++ names for this unit, such as "_m3_per_s". Throws the same errors as parse_unit().
std::string unit_suffix(std::string_view text);

/// Returns the exponents of the base units as text, such as "kg.m2/s3". If all exponents are zero, returns "1".
std::string base_unit_text(const Unit& unit);

}  // namespace mebots::modeldesc
