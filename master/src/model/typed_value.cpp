// SPDX-License-Identifier: Apache-2.0
#include "mebots/hexadecimal.hpp"
#include "mebots/nearest_names.hpp"
#include "mebots/parsed_number.hpp"
#include "model/resolved_system.hpp"
#include "model/value_kind.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace mebots::master {
namespace {

using modeldesc::Type;
using modeldesc::Variable;

template <typename T>
std::optional<T> parsed(const std::string& text) {
  const bool has_plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  return parsed_number<T>(std::string_view(text).substr(has_plus ? 1 : 0));
}

/// Throws errors with the problem, the place of the value and the type of the variable.
class Complaint {
 public:
  Complaint(const Variable& variable, const WrittenValue& written, const std::string& place)
      : variable_(variable), written_(written), place_(place) {}

  [[noreturn]] void fail(ErrorCode code, const std::string& what) const {
    throw InputError(code, fmt::format("{}: {}", place_, what));
  }
  [[noreturn]] void wrong_type(std::string_view wanted) const {
    fail(ErrorCode::wrong_type, fmt::format("'{}' is of type {} and takes {}, not {}", variable_.name,
                                            modeldesc::to_string(variable_.type), wanted, written_text(written_)));
  }

 private:
  const Variable& variable_;
  const WrittenValue& written_;
  const std::string& place_;
};

double real_value(const WrittenValue& written, const Complaint& complaint) {
  std::optional<double> value;
  if (const auto* number = std::get_if<double>(&written)) value = *number;
  if (const auto* number = std::get_if<std::int64_t>(&written)) value = static_cast<double>(*number);
  if (const auto* text = std::get_if<UntypedText>(&written)) value = parsed<double>(text->text);
  if (!value || !std::isfinite(*value)) complaint.wrong_type("a finite number");
  return *value;
}

std::optional<std::int64_t> signed_value(const WrittenValue& written) {
  if (const auto* number = std::get_if<std::int64_t>(&written)) return *number;
  if (const auto* text = std::get_if<UntypedText>(&written)) return parsed<std::int64_t>(text->text);
  return std::nullopt;
}

/// Returns a whole number. Throws InputError if it is outside of the range of the type. A UInt64 above 2^63 - 1 becomes
/// a negative number with the same bits.
std::int64_t whole_value(Type type, const WrittenValue& written, const Complaint& complaint) {
  const auto value = signed_value(written);
  if (const auto* text = std::get_if<UntypedText>(&written); text != nullptr && !value && type == Type::uint64) {
    if (const auto large = parsed<std::uint64_t>(text->text)) return static_cast<std::int64_t>(*large);
  }
  const auto limits = fmi::limits_of(type);
  if (!value || *value < limits.low || (*value > 0 && static_cast<std::uint64_t>(*value) > limits.high))
    complaint.wrong_type(fmt::format("a whole number from {} to {}", limits.low, limits.high));
  return *value;
}

bool boolean_value(const WrittenValue& written, const Complaint& complaint) {
  if (const auto* value = std::get_if<bool>(&written)) return *value;
  if (const auto* text = std::get_if<UntypedText>(&written)) {
    if (text->text == "true" || text->text == "1") return true;
    if (text->text == "false" || text->text == "0") return false;
  }
  complaint.wrong_type("true or false");
}

std::int64_t enumeration_value(const modeldesc::ModelDescription& description, const Variable& variable,
                               const WrittenValue& written, const Complaint& complaint) {
  const auto* type = description.type_definition(variable.declared_type);
  static const std::vector<modeldesc::EnumerationItem> kNoItems;
  const auto& items = type == nullptr ? kNoItems : type->items;
  std::vector<std::string> names;
  names.reserve(items.size());
  for (const auto& item : items) names.push_back(item.name);

  const auto* name = std::get_if<std::string>(&written);
  if (const auto* text = std::get_if<UntypedText>(&written)) {
    if (!parsed<std::int64_t>(text->text)) name = &text->text;
  }
  if (name != nullptr) {
    for (const auto& item : items) {
      if (item.name == *name) return item.value;
    }
    complaint.fail(ErrorCode::unknown_name,
                   fmt::format("'{}' is not an item of the enumeration '{}' of '{}'. {}", *name, variable.declared_type,
                               variable.name, suggest(*name, names)));
  }
  const auto number = signed_value(written);
  if (!number) complaint.wrong_type("the name or the number of an item");
  for (const auto& item : items) {
    if (item.value == *number) return *number;
  }
  complaint.fail(ErrorCode::unknown_name,
                 fmt::format("the enumeration '{}' of '{}' has no item with the number {}. {}", variable.declared_type,
                             variable.name, *number, suggest("", names)));
}

/// Converts pairs of hexadecimal digits to the bytes of a Binary.
std::string binary_value(const WrittenValue& written, const Complaint& complaint) {
  const auto* text = std::get_if<std::string>(&written);
  if (const auto* untyped = std::get_if<UntypedText>(&written)) text = &untyped->text;
  const auto bytes = text == nullptr ? std::nullopt : bytes_of_hexadecimal(*text);
  if (!bytes) complaint.wrong_type("bytes as pairs of hexadecimal digits, such as \"0aff\"");
  return *bytes;
}

}  // namespace

modeldesc::Value typed_value(const modeldesc::ModelDescription& description, const Variable& variable,
                             const WrittenValue& written, const std::string& place) {
  const Complaint complaint(variable, written, place);
  const auto check_limits = [&](double value) {
    if (variable.min && value < *variable.min) {
      complaint.fail(ErrorCode::value_out_of_range,
                     fmt::format("{} is below the minimum {} of '{}'", value, *variable.min, variable.name));
    }
    if (variable.max && value > *variable.max) {
      complaint.fail(ErrorCode::value_out_of_range,
                     fmt::format("{} is above the maximum {} of '{}'", value, *variable.max, variable.name));
    }
  };
  if (variable.type == Type::enumeration) return enumeration_value(description, variable, written, complaint);
  switch (kind_of(variable.type)) {
    case ValueKind::real: {
      auto value = real_value(written, complaint);
      if (variable.type == Type::float32) value = static_cast<float>(value);
      check_limits(value);
      return value;
    }
    case ValueKind::integer: {
      const auto value = whole_value(variable.type, written, complaint);
      check_limits(static_cast<double>(value));
      return value;
    }
    case ValueKind::boolean:
      return boolean_value(written, complaint);
    case ValueKind::binary:
      return binary_value(written, complaint);
    case ValueKind::clock:
      complaint.fail(ErrorCode::wrong_type, fmt::format("'{}' is a Clock, which has no value to set", variable.name));
    case ValueKind::string:
      break;
  }
  const auto* text = std::get_if<std::string>(&written);
  if (const auto* untyped = std::get_if<UntypedText>(&written)) text = &untyped->text;
  if (text == nullptr) complaint.wrong_type("a text");
  if (text->find('\0') != std::string::npos) {
    complaint.fail(
        ErrorCode::unknown_name,
        fmt::format("the text for '{}' contains a zero byte, where a text ends in FMI; remove it", variable.name));
  }
  return *text;
}

std::string value_text(modeldesc::Type type, const modeldesc::Value& value) {
  struct Text {
    Type type;
    std::string operator()(std::monostate /*none*/) const { return ""; }
    std::string operator()(double number) const {
      return type == Type::float32 ? fmt::format("{}", static_cast<float>(number)) : fmt::format("{}", number);
    }
    std::string operator()(std::int64_t number) const { return whole_text(type, number); }
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(const std::string& text) const { return type == Type::binary ? hexadecimal(text) : text; }
  };
  return std::visit(Text{type}, value);
}

}  // namespace mebots::master
