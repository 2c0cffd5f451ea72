// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/units.hpp"

#include "mebots/error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
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
      known("l", "_l", "litre", {0, 3}, 1e-3),
      known("km", "_km", "kilometre", kLength, 1e3),
      known("cm", "_cm", "centimetre", kLength, 1e-2),
      known("mm", "_mm", "millimetre", kLength, 1e-3),
      known("um", "_um", "micrometre", kLength, 1e-6),
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
      known("rad", "_rad", "radian", kAngle),
      known("deg", "_deg", "degree", kAngle, kDegree),
      known("rpm", "_rpm", "revolutions per minute", kAngularRate, 2 * std::numbers::pi / 60),
      known("N", "_n", "newton", kForce),
      known("mN", "_mn", "millinewton", kForce, 1e-3),
      known("Pa", "_pa", "pascal", kPressure),
      known("hPa", "_hpa", "hectopascal", kPressure, 100),
      known("kPa", "_kpa", "kilopascal", kPressure, 1e3),
      known("bar", "_bar", "bar", kPressure, 1e5),
      known("J", "_j", "joule", kEnergy),
      known("mJ", "_mj", "millijoule", kEnergy, 1e-3),
      known("uJ", "_uj", "microjoule", kEnergy, 1e-6),
      known("nJ", "_nj", "nanojoule", kEnergy, 1e-9),
      known("pJ", "_pj", "picojoule", kEnergy, 1e-12),
      known("kJ", "_kj", "kilojoule", kEnergy, 1e3),
      known("Wh", "_wh", "watt hour", kEnergy, 3600),
      known("mWh", "_mwh", "milliwatt hour", kEnergy, 3.6),
      known("kWh", "_kwh", "kilowatt hour", kEnergy, 3.6e6),
      known("W", "_w", "watt", kPower),
      known("mW", "_mw", "milliwatt", kPower, 1e-3),
      known("nW", "_nw", "nanowatt", kPower, 1e-9),
      known("uW", "_uw", "microwatt", kPower, 1e-6),
      known("kW", "_kw", "kilowatt", kPower, 1e3),
      known("A", "_a", "ampere", kCurrent),
      known("mA", "_ma", "milliampere", kCurrent, 1e-3),
      known("nA", "_na", "nanoampere", kCurrent, 1e-9),
      known("uA", "_ua", "microampere", kCurrent, 1e-6),
      known("C", "_c", "coulomb", kCharge),
      known("Ah", "_ah", "ampere hour", kCharge, 3600),
      known("mAh", "_mah", "milliampere hour", kCharge, 3.6),
      known("V", "_v", "volt", kVoltage),
      known("uV", "_uv", "microvolt", kVoltage, 1e-6),
      known("mV", "_mv", "millivolt", kVoltage, 1e-3),
      known("kV", "_kv", "kilovolt", kVoltage, 1e3),
      known("Ohm", "_ohm", "ohm", kResistance),
      known("mOhm", "_mohm", "milliohm", kResistance, 1e-3),
      known("kOhm", "_kohm", "kiloohm", kResistance, 1e3),
      known("F", "_f", "farad", kCapacitance),
      known("mF", "_mf", "millifarad", kCapacitance, 1e-3),
      known("uF", "_uf", "microfarad", kCapacitance, 1e-6),
      known("nF", "_nf", "nanofarad", kCapacitance, 1e-9),
      known("pF", "_pf", "picofarad", kCapacitance, 1e-12),
      known("H", "_henry", "henry", kInductance),
      known("mH", "_millihenry", "millihenry", kInductance, 1e-3),
      known("uH", "_microhenry", "microhenry", kInductance, 1e-6),
      known("T", "_t", "tesla", kMagneticFlux),
      known("K", "_k", "kelvin", kTemperature),
      known("degC", "_degc", "degree Celsius", kTemperature, 1, 273.15),
      known("lx", "_lx", "lux", {0, -2, 0, 0, 0, 0, 1}),
      known("cd", "_cd", "candela", {0, 0, 0, 0, 0, 0, 1}),
      known("mol", "_mol", "mole", {0, 0, 0, 0, 0, 1}),
  };
}

const KnownUnit* find_known_unit(std::string_view name) {
  const auto units = known_units();
  const auto found = std::ranges::find_if(units, [&](const KnownUnit& known) { return known.unit.name == name; });
  return found == units.end() ? nullptr : &*found;
}

struct Factor {
  const KnownUnit* unit;
  int exponent;
};

/// Parses a unit expression of FMI 2.0, which has Modelica's grammar:
///
///     expression = numerator [ "/" denominator ]
///     numerator = "1" | factor { "." factor } | "(" expression ")"
///     denominator = factor | "(" expression ")"
///     factor = known unit [ [ "+" | "-" ] digits ]
class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : text_(text) {}

  std::vector<Factor> factors() {
    constexpr std::size_t kLongest = 100;  // also limits the depth of brackets
    if (text_.size() > kLongest) fail(fmt::format("longer than {} characters", kLongest));
    expression(1);
    if (at_ < text_.size()) {
      fail(text_[at_] == '/' ? "a second '/'; put the denominator into brackets, as in J/(kg.K)"
                             : expected("'.' or '/'"));
    }
    return std::move(factors_);
  }

 private:
  void expression(int sign) {
    if (take('(')) {
      expression(sign);
      close();
    } else if (peek() == '1' && !is_digit(at_ + 1)) {
      ++at_;
    } else {
      do {
        factor(sign);
      } while (take('.'));
    }
    if (!take('/')) return;
    if (take('(')) {
      expression(-sign);
      close();
    } else {
      factor(-sign);
      if (peek() == '.') fail("a product behind '/'; put the denominator into brackets, as in J/(kg.K)");
    }
  }

  void factor(int sign) {
    const auto begin = at_;
    while (at_ < text_.size() && (std::isalpha(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '%'))
      ++at_;
    if (at_ == begin) fail(expected("a unit"));
    const auto name = text_.substr(begin, at_ - begin);
    const auto* const unit = find_known_unit(name);
    if (unit == nullptr) fail_unknown(name);
    factors_.push_back({unit, sign * exponent()});
  }

  int exponent() {
    constexpr int kMost = 20;
    const bool negative = peek() == '-';
    if (negative || peek() == '+') {
      ++at_;
      if (!is_digit(at_)) fail(expected("an exponent"));
    } else if (!is_digit(at_)) {
      return 1;
    }
    int value = 0;
    for (; is_digit(at_); ++at_) {
      value = 10 * value + (text_[at_] - '0');
      if (value > kMost) fail(fmt::format("an exponent above {}", kMost));
    }
    if (value == 0) fail("an exponent of 0");
    return negative ? -value : value;
  }

  void close() {
    if (!take(')')) fail(expected("')'"));
  }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  bool is_digit(std::size_t at) const { return at < text_.size() && text_[at] >= '0' && text_[at] <= '9'; }
  bool take(char wanted) {
    if (peek() != wanted) return false;
    ++at_;
    return true;
  }

  std::string expected(std::string_view what) const {
    return at_ == 0 ? fmt::format("{} is expected at the start", what)
                    : fmt::format("{} is expected behind '{}'", what, text_.substr(0, at_));
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(
        ErrorCode::wrong_unit,
        fmt::format("\"{}\" is not a unit: {}; a unit is 1 or a product such as m/s2, kg.m2 or rad/(s.V)", text_, why));
  }
  [[noreturn]] void fail_unknown(std::string_view name) const {
    std::vector<std::string> known;
    for (const auto& unit : known_units()) known.push_back(unit.unit.name);
    throw Error(ErrorCode::wrong_unit,
                name == text_
                    ? fmt::format("the unit '{}' is unknown. {}", name, suggest(name, known))
                    : fmt::format("the unit '{}' in \"{}\" is unknown. {}", name, text_, suggest(name, known)));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<Factor> factors_;
};

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
  // In FMI 2.0: value_SI = factor * value + offset.
  if (same_unit(from, to)) return {};
  return {from.factor / to.factor, difference ? 0 : (from.offset - to.offset) / to.factor};
}

std::span<const KnownUnit> known_units() {
  static const std::vector<KnownUnit> table = make_table();
  return table;
}

Unit parse_unit(std::string_view text) {
  const auto factors = UnitParser(text).factors();
  Unit result;
  result.name = text;
  for (const auto& [known, exponent] : factors) {
    for (std::size_t i = 0; i < result.exponents.size(); ++i)
      result.exponents[i] += exponent * known->unit.exponents[i];
    for (int i = 0; i < exponent; ++i) result.factor *= known->unit.factor;
    for (int i = 0; i > exponent; --i) result.factor /= known->unit.factor;
  }
  if (factors.size() == 1 && factors[0].exponent == 1) result.offset = factors[0].unit->unit.offset;
  if (!std::isnormal(result.factor)) {
    throw Error(ErrorCode::wrong_unit, fmt::format("\"{}\" is beyond all numbers in SI units", text));
  }
  return result;
}

std::string unit_suffix(std::string_view text) {
  std::string above;
  std::string below;
  for (const auto& [known, exponent] : UnitParser(text).factors()) {
    std::string& side = exponent > 0 ? above : below;
    side += known->suffix;
    if (std::abs(exponent) != 1) side += std::to_string(std::abs(exponent));
  }
  return below.empty() ? above : above + "_per" + below;
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
