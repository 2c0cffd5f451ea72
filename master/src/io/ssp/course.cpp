// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include "mebots/input_error.hpp"
#include "mebots/parsed_number.hpp"
#include "model/unit_rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::master::ssp {
namespace {

bool is_true(std::string_view text) {
  return text == "true" || text == "1";
}

/// Returns the canonical form of a value in a map. Equal values have equal texts.
std::string plain(ValueMap::Kind kind, const std::string& text) {
  return kind == ValueMap::Kind::boolean ? (is_true(text) ? "true" : "false") : text;
}

const std::string* target_of(const ValueMap& map, std::string_view source) {
  const auto found =
      std::ranges::find_if(map.entries, [&](const auto& entry) { return plain(map.kind, entry.first) == source; });
  return found == map.entries.end() ? nullptr : &found->second;
}

std::string text_in_map(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace

void Course::pass(const Transformation& transformation, const std::optional<modeldesc::Unit>& unit) {
  if (transformation.convert_units) {
    convert(unit, transformation.place);
  } else {
    unit_ = unit;
  }
  if (const auto* linear = std::get_if<Linear>(&transformation.what)) transform(*linear, transformation.place);
  if (const auto* map = std::get_if<ValueMap>(&transformation.what)) transform(*map, transformation.place);
}

/// Converts the value to the unit of a connector. If the connector has no unit, the value keeps its unit.
void Course::convert(const std::optional<modeldesc::Unit>& unit, const std::string& place) {
  if (!unit) return;
  if (unit_) {
    try {
      const auto conversion = conversion_between(*unit_, *unit, difference_);
      shifts_units_ |= conversion.offset != 0;
      converts_units_ |= conversion.factor != 1 || conversion.offset != 0;
      transform(Linear{conversion.factor, conversion.offset}, place);
    } catch (const InputError&) {
      throw;
    } catch (const Error& error) {
      throw InputError(error.code(), fmt::format("{}: {}", place, error.what()));
    }
  }
  unit_ = unit;
}

void Course::transform(const Linear& linear, const std::string& place) {
  if (linear.factor == 1 && linear.offset == 0) return;
  if (map_) throw InputError(fmt::format("{}: a mapped value cannot be transformed linearly as well", place));
  factor_ *= linear.factor;
  offset_ = offset_ * linear.factor + linear.offset;
  check_range(place);
}

void Course::transform(const ValueMap& map, const std::string& place) {
  if (factor_ != 1 || offset_ != 0) {
    throw InputError(fmt::format("{}: a value that was transformed linearly cannot be mapped as well", place));
  }
  if (!map_) {
    map_ = map;
    for (auto& [source, target] : map_->entries) {
      source = plain(map.kind, source);
      target = plain(map.kind, target);
    }
    return;
  }
  if (map_->kind != map.kind) throw InputError(fmt::format("{}: two kinds of maps follow each other", place));
  auto both = *map_;
  for (auto& [source, target] : both.entries) {
    if (const auto* further = target_of(map, target)) target = plain(map.kind, *further);
  }
  for (const auto& [source, target] : map.entries) {
    if (target_of(*map_, plain(map.kind, source)) == nullptr) {
      both.entries.emplace_back(plain(map.kind, source), plain(map.kind, target));
    }
  }
  map_ = std::move(both);
}

void Course::check_range(const std::string& place) const {
  if (std::isfinite(factor_) && std::isfinite(offset_)) return;
  throw InputError(fmt::format("{}: a transformation of this connection leaves the range of numbers", place));
}

Json Course::apply(const Json& value, const std::string& name) const {
  if (map_) {
    const auto* target = target_of(*map_, text_in_map(value));
    if (target == nullptr) return value;
    if (map_->kind == ValueMap::Kind::boolean) return is_true(*target);
    if (map_->kind == ValueMap::Kind::enumeration) return *target;
    const auto number = parsed_number<std::int64_t>(*target);
    if (!number)
      throw InputError(fmt::format("{}: \"{}\" is not a whole number that fits into 64 bits", name, *target));
    return *number;
  }
  if (factor_ == 1 && offset_ == 0) return value;
  if (!value.is_number()) {
    throw InputError(ErrorCode::wrong_type,
                     fmt::format("{} is {}, but only numbers can be transformed linearly", name, value.dump()));
  }
  const double result = factor_ * value.get<double>() + offset_;
  if (!std::isfinite(result)) {
    throw InputError(fmt::format("{}: a transformation of this connection leaves the range of numbers", name));
  }
  return result;
}

}  // namespace mebots::master::ssp
