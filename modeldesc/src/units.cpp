// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mebots::modeldesc {
namespace {

using Exponents = std::array<int, 8>;

//                            kg  m   s   A  K  mol cd rad
constexpr Exponents kNone = {};
constexpr Exponents kMass = {1};
constexpr Exponents kLength = {0, 1};
constexpr Exponents kTime = {0, 0, 1};
constexpr Exponents kCurrent = {0, 0, 0, 1};
constexpr Exponents kTemperature = {0, 0, 0, 0, 1};
constexpr Exponents kAngle = {0, 0, 0, 0, 0, 0, 0, 1};
constexpr Exponents kRate = {0, 0, -1};
constexpr Exponents kAngularRate = {0, 0, -1, 0, 0, 0, 0, 1};
constexpr Exponents kVelocity = {0, 1, -1};
constexpr Exponents kAcceleration = {0, 1, -2};
constexpr Exponents kForce = {1, 1, -2};
constexpr Exponents kEnergy = {1, 2, -2};
constexpr Exponents kPower = {1, 2, -3};
constexpr Exponents kCharge = {0, 0, 1, 1};
constexpr Exponents kVoltage = {1, 2, -3, -1};
constexpr Exponents kResistance = {1, 2, -3, -2};
constexpr Exponents kCapacitance = {-1, -2, 4, 2};
constexpr Exponents kInductance = {1, 2, -2, -2};
constexpr Exponents kPressure = {1, -1, -2};
constexpr Exponents kMagneticFlux = {1, 0, -2, -1};  // density

KnownUnit known(const char* name, const char* suffix, const char* text, const Exponents& exponents, double factor = 1,
                double offset = 0) {
  KnownUnit result;
  result.unit.name = name;
  result.unit.exponents = exponents;
  result.unit.factor = factor;
  result.unit.offset = offset;
  result.suffix = suffix;
  result.text = text;
  return result;
}

std::vector<KnownUnit> make_table() {
  constexpr double kDegree = std::numbers::pi / 180;
  return {
      known("1", "", "one", kNone),
      known("%", "_percent", "per cent", kNone, 0.01),
      known("ppm", "_ppm", "parts per million", kNone, 1e-6),
      known("kg", "_kg", "kilogram", kMass),
      known("g", "_g", "gram", kMass, 1e-3),
      known("m", "_m", "metre", kLength),
      known("km", "_km", "kilometre", kLength, 1e3),
      known("cm", "_cm", "centimetre", kLength, 1e-2),
      known("mm", "_mm", "millimetre", kLength, 1e-3),
      known("um", "_um", "micrometre", kLength, 1e-6),
      known("m2", "_m2", "square metre", {0, 2}),
      known("m3", "_m3", "cubic metre", {0, 3}),
      known("s", "_s", "second", kTime),
      known("ms", "_ms", "millisecond", kTime, 1e-3),
      known("us", "_us", "microsecond", kTime, 1e-6),
      known("ns", "_ns", "nanosecond", kTime, 1e-9),
      known("min", "_min", "minute", kTime, 60),
      known("h", "_h", "hour", kTime, 3600),
      known("Hz", "_hz", "hertz", kRate),
      known("kHz", "_khz", "kilohertz", kRate, 1e3),
      known("MHz", "_mhz", "megahertz", kRate, 1e6),
      known("GHz", "_ghz", "gigahertz", kRate, 1e9),
      known("1/s", "_per_s", "per second", kRate),
      known("rad", "_rad", "radian", kAngle),
      known("deg", "_deg", "degree", kAngle, kDegree),
      known("rad/s", "_rad_per_s", "radian per second", kAngularRate),
      known("deg/s", "_deg_per_s", "degree per second", kAngularRate, kDegree),
      known("rpm", "_rpm", "revolutions per minute", kAngularRate, 2 * std::numbers::pi / 60),
      known("rad/s2", "_rad_per_s2", "radian per second squared", {0, 0, -2, 0, 0, 0, 0, 1}),
      known("m/s", "_m_per_s", "metre per second", kVelocity),
      known("km/h", "_km_per_h", "kilometre per hour", kVelocity, 1 / 3.6),
      known("m/s2", "_m_per_s2", "metre per second squared", kAcceleration),
      known("N", "_n", "newton", kForce),
      known("mN", "_mn", "millinewton", kForce, 1e-3),
      known("N.m", "_n_m", "newton metre", kEnergy),
      known("kg.m2", "_kg_m2", "kilogram square metre", {1, 2}),
      known("kg/m3", "_kg_per_m3", "kilogram per cubic metre", {1, -3}),
      known("Pa", "_pa", "pascal", kPressure),
      known("hPa", "_hpa", "hectopascal", kPressure, 100),
      known("kPa", "_kpa", "kilopascal", kPressure, 1e3),
      known("bar", "_bar", "bar", kPressure, 1e5),
      known("J", "_j", "joule", kEnergy),
      known("mJ", "_mj", "millijoule", kEnergy, 1e-3),
      known("kJ", "_kj", "kilojoule", kEnergy, 1e3),
      known("Wh", "_wh", "watt hour", kEnergy, 3600),
      known("mWh", "_mwh", "milliwatt hour", kEnergy, 3.6),
      known("kWh", "_kwh", "kilowatt hour", kEnergy, 3.6e6),
      known("W", "_w", "watt", kPower),
      known("mW", "_mw", "milliwatt", kPower, 1e-3),
      known("uW", "_uw", "microwatt", kPower, 1e-6),
      known("kW", "_kw", "kilowatt", kPower, 1e3),
      known("A", "_a", "ampere", kCurrent),
      known("mA", "_ma", "milliampere", kCurrent, 1e-3),
      known("uA", "_ua", "microampere", kCurrent, 1e-6),
      known("C", "_c", "coulomb", kCharge),
      known("Ah", "_ah", "ampere hour", kCharge, 3600),
      known("mAh", "_mah", "milliampere hour", kCharge, 3.6),
      known("V", "_v", "volt", kVoltage),
      known("mV", "_mv", "millivolt", kVoltage, 1e-3),
      known("kV", "_kv", "kilovolt", kVoltage, 1e3),
      known("Ohm", "_ohm", "ohm", kResistance),
      known("mOhm", "_mohm", "milliohm", kResistance, 1e-3),
      known("kOhm", "_kohm", "kiloohm", kResistance, 1e3),
      known("F", "_f", "farad", kCapacitance),
      known("H", "_henry", "henry", kInductance),
      known("T", "_t", "tesla", kMagneticFlux),
      known("K", "_k", "kelvin", kTemperature),
      known("degC", "_degc", "degree Celsius", kTemperature, 1, 273.15),
      known("W/K", "_w_per_k", "watt per kelvin", {1, 2, -3, 0, -1}),
      known("J/K", "_j_per_k", "joule per kelvin", {1, 2, -2, 0, -1}),
      known("lx", "_lx", "lux", {0, -2, 0, 0, 0, 0, 1}),
      known("cd", "_cd", "candela", {0, 0, 0, 0, 0, 0, 1}),
      known("mol", "_mol", "mole", {0, 0, 0, 0, 0, 1}),
  };
}

}  // namespace

bool same_dimension(const Unit& a, const Unit& b) {
  if (!a.has_base || !b.has_base) return a.name == b.name;
  return a.exponents == b.exponents;
}

bool same_unit(const Unit& a, const Unit& b) {
  const auto close = [](double x, double y) { return std::abs(x - y) <= 1e-12 * std::max(std::abs(x), std::abs(y)); };
  return same_dimension(a, b) && close(a.factor, b.factor) && close(a.offset, b.offset);
}

UnitConversion unit_conversion(const Unit& from, const Unit& to, bool difference) {
  // FMI 2.0: value_SI = factor * value + offset.
  if (same_unit(from, to)) return {};
  return {from.factor / to.factor, difference ? 0 : (from.offset - to.offset) / to.factor};
}

std::span<const KnownUnit> known_units() {
  static const std::vector<KnownUnit> table = make_table();
  return table;
}

const KnownUnit* find_known_unit(std::string_view name) {
  const auto units = known_units();
  const auto found = std::ranges::find_if(units, [&](const KnownUnit& known) { return known.unit.name == name; });
  return found == units.end() ? nullptr : &*found;
}

std::string base_unit_text(const Unit& unit) {
  std::string above;
  std::string below;
  for (std::size_t i = 0; i < kBaseUnits.size(); ++i) {
    const int exponent = unit.exponents[i];
    if (exponent == 0) continue;
    std::string& side = exponent > 0 ? above : below;
    if (!side.empty()) side += '.';
    side += kBaseUnits[i];
    if (std::abs(exponent) != 1) side += std::to_string(std::abs(exponent));
  }
  if (above.empty()) above = "1";
  if (below.empty()) return above;
  return above + (below.find('.') == std::string::npos ? "/" + below : "/(" + below + ")");
}

}  // namespace mebots::modeldesc
