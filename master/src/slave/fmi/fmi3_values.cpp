// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/fmi3_values.hpp"

#include "mebots/assert.hpp"

#include "fmi/call/callbacks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <span>

namespace mebots::master {
namespace {

using modeldesc::Type;

/// The maximum size of a Binary in bytes. An FMU that returns a larger value fails.
constexpr std::size_t kLongestBinary = std::size_t{1} << 30;
/// The maximum number of cached lists of value references for each kind of variable. Most instances use fewer lists.
constexpr std::size_t kMostPlans = 32;

/// Guard bytes after the numbers of a get function. If they have changed, the FMU has written too many values.
constexpr auto kGuard = [] {
  std::array<std::byte, 256> bytes{};
  bytes.fill(std::byte{0xA5});
  return bytes;
}();

template <typename T, typename Get, typename Set>
struct NumberFunctions {
  using Number = T;
  Get* get;
  Set* set;
  const char* get_name;
  const char* set_name;
};

template <typename T, typename Get, typename Set>
NumberFunctions<T, Get, Set> number_functions(Get* get, Set* set, const char* get_name, const char* set_name) {
  return {get, set, get_name, set_name};
}

constexpr bool succeeded(int status) {
  return status == InstanceCalls::kOk || status == InstanceCalls::kWarning;
}

/// Returns the name of a variable for messages. `variable` is null for an array element that the caller did not
/// request.
std::string name_of(const modeldesc::Variable* variable) {
  return variable == nullptr ? "another element of an array" : variable->name;
}

std::size_t longest(const modeldesc::Variable* variable) {
  const auto declared = variable == nullptr ? std::nullopt : variable->fmi3->max_size;
  return std::min<std::uint64_t>(declared.value_or(kLongestBinary), kLongestBinary);
}

}  // namespace

Fmi3Values::Fmi3Values(InstanceCalls& calls, const Fmi3Functions& functions, const modeldesc::ModelDescription& model)
    : calls_(&calls), functions_(&functions) {
  for (const auto& variable : model.variables) {
    const auto& element = variable.fmi3->element;
    const auto place = element
                           ? Place{variable.type, element->array_reference, element->index, element->count, &variable}
                           : Place{variable.type, variable.value_reference, 0, 1, &variable};
    places_.emplace(variable.value_reference, place);
  }
}

const Fmi3Values::Plan& Fmi3Values::plan(ValueKind kind, std::span<const ValueReference> references) {
  auto& plans = plans_[static_cast<std::size_t>(kind)];
  const auto found =
      std::ranges::find_if(plans, [&](const Plan& plan) { return std::ranges::equal(plan.references, references); });
  if (found != plans.end()) return *found;
  if (plans.size() == kMostPlans) plans.erase(plans.begin());
  return plans.emplace_back(make_plan(references));
}

Fmi3Values::Plan Fmi3Values::make_plan(std::span<const ValueReference> references) const {
  Plan plan;
  plan.references.assign(references.begin(), references.end());
  std::map<std::pair<Type, std::uint32_t>, std::size_t> firsts;  // index of the first value of an array in its call
  for (std::size_t slot = 0; slot < references.size(); ++slot) {
    const auto place = places_.find(references[slot]);
    MEBOTS_ASSERT(place != places_.end(), "references come from the model");
    const auto& [type, reference, index, count, variable] = place->second;
    auto call = std::ranges::find(plan.calls, type, &Call::type);
    if (call == plan.calls.end()) call = plan.calls.insert(call, Call{type, {}, {}, 0, {}});
    const auto [first, is_new] = firsts.emplace(std::pair(type, reference), call->value_count);
    if (is_new) {
      call->references.push_back(reference);
      call->value_count += count;
      call->variables.resize(call->value_count, nullptr);
    }
    call->variables[first->second + index] = variable;
    call->moves.push_back({first->second + index, slot});
  }
  return plan;
}

Fmi3Values::Whole Fmi3Values::whole(std::span<const ValueReference> references) const {
  Whole result;
  std::map<std::uint32_t, std::size_t> firsts;  // index of the first value of a variable
  for (const auto reference : references) {
    const auto place = places_.find(reference);
    MEBOTS_ASSERT(place != places_.end(), "references come from the model");
    const auto [first, is_new] = firsts.emplace(place->second.reference, result.value_count);
    if (is_new) {
      result.references.push_back(place->second.reference);
      result.value_count += place->second.count;
    }
    result.places.push_back(first->second + place->second.index);
  }
  return result;
}

template <typename T>
T* Fmi3Values::buffer(std::size_t count) {
  guard_ = count * sizeof(T);
  if (buffer_.size() < guard_ + kGuard.size()) buffer_.resize(guard_ + kGuard.size());
  return reinterpret_cast<T*>(buffer_.data());
}

void Fmi3Values::put_guard() {
  std::memcpy(buffer_.data() + guard_, kGuard.data(), kGuard.size());
}

/// Throws SlaveError if the FMU has written more values than requested.
void Fmi3Values::check_guard(const Call& call, const char* function) const {
  if (std::memcmp(buffer_.data() + guard_, kGuard.data(), kGuard.size()) == 0) return;
  const auto* const variable = call.variables[call.moves.back().value];
  const auto& element = variable->fmi3->element;
  calls_->fail(function, fmt::format("wrote more than the {} values of '{}' that were requested", call.value_count,
                                     element ? element->array : variable->name));
}

template <typename Action>
void Fmi3Values::with_functions(Type type, Action action) {
  const auto& f = *functions_;
#define MEBOTS_CASE(enumerator, T, name, get, set) \
  case Type::enumerator:                           \
    return action(number_functions<T>(f.get, f.set, "fmi3Get" name, "fmi3Set" name));
  switch (type) {
    MEBOTS_CASE(real, double, "Float64", get_float64, set_float64)
    MEBOTS_CASE(float32, float, "Float32", get_float32, set_float32)
    MEBOTS_CASE(int8, std::int8_t, "Int8", get_int8, set_int8)
    MEBOTS_CASE(uint8, std::uint8_t, "UInt8", get_uint8, set_uint8)
    MEBOTS_CASE(int16, std::int16_t, "Int16", get_int16, set_int16)
    MEBOTS_CASE(uint16, std::uint16_t, "UInt16", get_uint16, set_uint16)
    MEBOTS_CASE(integer, std::int32_t, "Int32", get_int32, set_int32)
    MEBOTS_CASE(uint32, std::uint32_t, "UInt32", get_uint32, set_uint32)
    case Type::enumeration:
      MEBOTS_CASE(int64, std::int64_t, "Int64", get_int64, set_int64)
      MEBOTS_CASE(uint64, std::uint64_t, "UInt64", get_uint64, set_uint64)
      MEBOTS_CASE(boolean, bool, "Boolean", get_boolean, set_boolean)
    case Type::string:
    case Type::binary:
    case Type::clock:
      MEBOTS_ASSERT(false, "not a type of numbers");
  }
#undef MEBOTS_CASE
}

template <typename Value>
Fmi3Values::CallResult Fmi3Values::get_numbers(const Plan& plan, std::span<Value> values) {
  CallResult result;
  for (const auto& call : plan.calls) {
    with_functions(call.type, [&](auto functions) {
      using Number = typename decltype(functions)::Number;
      calls_->require_function(functions.get_name, functions.get);
      auto* const numbers = buffer<Number>(call.value_count);
      put_guard();
      result = {calls_->call(functions.get_name, functions.get, call.references.data(), call.references.size(), numbers,
                             call.value_count),
                functions.get_name};
      check_guard(call, functions.get_name);
      if constexpr (std::is_same_v<Number, bool>) {  // an FMU may store any byte, but a bool must be 0 or 1
        for (const auto& move : call.moves) values[move.slot] = buffer_[move.value] != std::byte{0} ? 1 : 0;
      } else {
        // An Int8 is a signed number. NOLINTNEXTLINE(bugprone-signed-char-misuse)
        for (const auto& move : call.moves) values[move.slot] = static_cast<Value>(numbers[move.value]);
      }
    });
    if (!succeeded(result.status)) break;
  }
  return result;
}

template <typename Value>
Fmi3Values::CallResult Fmi3Values::set_numbers(const Plan& plan, std::span<const Value> values) {
  CallResult result;
  for (const auto& call : plan.calls) {
    with_functions(call.type, [&](auto functions) {
      using Number = typename decltype(functions)::Number;
      calls_->require_function(functions.set_name, functions.set);
      auto* const numbers = buffer<Number>(call.value_count);
      if (call.moves.size() < call.value_count) {  // reads the values of the other elements
        put_guard();
        calls_->require(functions.get_name, functions.get, call.references.data(), call.references.size(), numbers,
                        call.value_count);
        check_guard(call, functions.get_name);
      }
      for (const auto& move : call.moves) numbers[move.value] = static_cast<Number>(values[move.slot]);
      result = {calls_->call(functions.set_name, functions.set, call.references.data(), call.references.size(),
                             static_cast<const Number*>(numbers), call.value_count),
                functions.set_name};
    });
    if (!succeeded(result.status)) break;
  }
  return result;
}

/// Returns false if the FMU has discarded the call. Throws SlaveError if the call has failed.
bool Fmi3Values::is_done(CallResult result) {
  if (result.status != fmi3Discard) {
    calls_->check(result.status, result.function);
    return true;
  }
  calls_->deliver_held();
  return false;
}

Fmi3Values::CallResult Fmi3Values::get_reals(std::span<const ValueReference> references, std::span<double> values) {
  const auto& chosen = plan(ValueKind::real, references);
  const auto& calls = chosen.calls;
  // The usual list contains only Float64 scalars. Their values are already in the order of the caller.
  if (calls.size() == 1 && calls.front().type == Type::real && calls.front().references.size() == references.size() &&
      calls.front().value_count == references.size()) {
    constexpr const char* kFunction = "fmi3GetFloat64";
    return {calls_->call(kFunction, functions_->get_float64, calls.front().references.data(), references.size(),
                         values.data(), values.size()),
            kFunction};
  }
  return get_numbers(chosen, values);
}

void Fmi3Values::get(std::span<const ValueReference> references, std::span<double> values) {
  const auto result = get_reals(references, values);
  calls_->check(result.status, result.function);
}

bool Fmi3Values::try_get(std::span<const ValueReference> references, std::span<double> values) {
  return is_done(get_reals(references, values));
}

void Fmi3Values::get(ValueKind kind, std::span<const ValueReference> references, std::span<std::int64_t> values) {
  const auto result = get_numbers(plan(kind, references), values);
  calls_->check(result.status, result.function);
}

void Fmi3Values::set(std::span<const ValueReference> references, std::span<const double> values) {
  const auto result = set_numbers(plan(ValueKind::real, references), values);
  calls_->check(result.status, result.function);
}

bool Fmi3Values::try_set(std::span<const ValueReference> references, std::span<const double> values) {
  return is_done(set_numbers(plan(ValueKind::real, references), values));
}

void Fmi3Values::set(ValueKind kind, std::span<const ValueReference> references, std::span<const std::int64_t> values) {
  const auto result = set_numbers(plan(kind, references), values);
  calls_->check(result.status, result.function);
}

void Fmi3Values::get(ValueKind kind, std::span<const ValueReference> references, std::span<std::string> values) {
  for (const auto& call : plan(kind, references).calls) {
    if (kind == ValueKind::binary) {
      get_binaries(call, values);
    } else {
      get_texts(call, values);
    }
  }
}

void Fmi3Values::get_texts(const Call& call, std::span<std::string> values) {
  calls_->require_function("fmi3GetString", functions_->get_string);
  std::vector<fmi3String> texts(call.value_count, nullptr);
  calls_->require("fmi3GetString", functions_->get_string, call.references.data(), call.references.size(), texts.data(),
                  texts.size());
  for (const auto& move : call.moves) {
    const auto* const address = texts[move.value];
    const auto text = read_text(address, std::numeric_limits<std::size_t>::max());
    if (!text && address != nullptr) {
      calls_->fail("fmi3GetString", fmt::format("returned the address {} for '{}', where no text can be read",
                                                fmt::ptr(address), name_of(call.variables[move.value])));
    }
    values[move.slot] = text.value_or("");
  }
}

void Fmi3Values::get_binaries(const Call& call, std::span<std::string> values) {
  calls_->require_function("fmi3GetBinary", functions_->get_binary);
  std::vector<std::size_t> sizes(call.value_count, 0);
  std::vector<fmi3Binary> binaries(call.value_count, nullptr);
  calls_->require("fmi3GetBinary", functions_->get_binary, call.references.data(), call.references.size(), sizes.data(),
                  binaries.data(), binaries.size());
  for (const auto& move : call.moves) {
    const auto size = sizes[move.value];
    const auto* const variable = call.variables[move.value];
    const auto limit = longest(variable);
    if (size > limit) {
      calls_->fail("fmi3GetBinary",
                   fmt::format("returned {} bytes for '{}', which has at most {}", size, name_of(variable), limit));
    }
    const auto* const bytes = binaries[move.value];
    if (size != 0 && (bytes == nullptr || !is_readable(std::span(bytes, size)))) {
      calls_->fail("fmi3GetBinary",
                   fmt::format("returned the address {} for the {} bytes of '{}', which cannot be read",
                               fmt::ptr(bytes), size, name_of(variable)));
    }
    values[move.slot].assign(reinterpret_cast<const char*>(bytes), size);
  }
}

void Fmi3Values::set(ValueKind kind, std::span<const ValueReference> references, std::span<const std::string> values) {
  for (const auto& call : plan(kind, references).calls) {
    std::vector<std::string> all(call.value_count);
    if (call.moves.size() < call.value_count) {  // reads the values of the other elements
      auto whole = call;
      whole.moves.clear();
      for (std::size_t i = 0; i < call.value_count; ++i) whole.moves.push_back({i, i});
      kind == ValueKind::binary ? get_binaries(whole, all) : get_texts(whole, all);
    }
    for (const auto& move : call.moves) all[move.value] = values[move.slot];
    if (kind == ValueKind::binary) {
      calls_->require_function("fmi3SetBinary", functions_->set_binary);
      std::vector<std::size_t> sizes;
      std::vector<fmi3Binary> binaries;
      for (const auto& bytes : all) {
        sizes.push_back(bytes.size());
        binaries.push_back(reinterpret_cast<fmi3Binary>(bytes.data()));
      }
      calls_->require("fmi3SetBinary", functions_->set_binary, call.references.data(), call.references.size(),
                      sizes.data(), binaries.data(), binaries.size());
    } else {
      calls_->require_function("fmi3SetString", functions_->set_string);
      std::vector<fmi3String> texts;
      for (const auto& text : all) texts.push_back(text.c_str());
      calls_->require("fmi3SetString", functions_->set_string, call.references.data(), call.references.size(),
                      texts.data(), texts.size());
    }
  }
}

}  // namespace mebots::master
