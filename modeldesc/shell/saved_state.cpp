// SPDX-License-Identifier: Apache-2.0
#include "saved_state.hpp"

#include "mebots/error.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>

#include <string>

namespace mebots::shell {
namespace {

constexpr std::uint64_t kMagic = 0x3153'746F'6245'4D89;  // 0x89 "MEbotS1", read as little endian
constexpr std::uint32_t kFormat = 2;

/// FNV-1a, 64 bits (Fowler, Noll, Vo). Detects damage, but does not protect against manipulation.
std::uint64_t checksum(std::uint64_t layout, std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xCBF2'9CE4'8422'2325 ^ layout;
  for (const std::byte byte : bytes) hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x0000'0100'0000'01B3;
  return hash;
}

}  // namespace

void SavedState::visit(state::Visitor& v) {
  v("state", state);
  v("experiment_is_set", experiment_is_set);
  v("model_is_stale", model_is_stale);
  v("start_ns", start_ns);
  v("time_ns", time_ns);
  v("stop_ns", stop_ns);
  v("parameters", parameters);
  v("inputs", inputs);
  v("outputs", outputs);
  v("model", model);
}

std::vector<std::byte> serialize(const Owner& owner, const SavedState& saved) {
  const std::vector<std::byte> payload = state::save(saved);
  state::Writer writer;
  writer.put(kMagic);
  writer.put(kFormat);
  writer.put(std::string(owner.model_identifier));
  writer.put(std::string(owner.token));
  writer.put(saved.layout);
  writer.put(checksum(saved.layout, payload));
  writer.put(payload);
  return writer.take();
}

SavedState deserialize(const Owner& owner, std::span<const std::byte> bytes) {
  constexpr const char* kRemedy = "serialise a state of this FMU and version again";
  state::Reader reader(bytes);
  if (bytes.size() < sizeof kMagic || reader.get<std::uint64_t>() != kMagic)
    throw Error(ErrorCode::state_damaged,
                fmt::format("these {} bytes are not a state of a MEbots FMU; {}", bytes.size(), kRemedy));
  if (const auto format = reader.get<std::uint32_t>(); format != kFormat)
    throw Error(ErrorCode::state_of_other_build,
                fmt::format("the state has format {}, this FMU reads format {}; {}", format, kFormat, kRemedy));
  std::string identifier;
  std::string token;
  reader.get(identifier);
  reader.get(token);
  if (identifier != owner.model_identifier)
    throw Error(ErrorCode::state_of_other_fmu,
                fmt::format("the state belongs to {}, this is {}", identifier, owner.model_identifier));
  if (token != owner.token)
    throw Error(ErrorCode::state_of_other_build,
                fmt::format("the state belongs to {} with {} {}, this one has {}; {}", identifier, owner.token_name,
                            token, owner.token, kRemedy));
  const auto layout = reader.get<std::uint64_t>();
  const auto expected = reader.get<std::uint64_t>();
  std::vector<std::byte> payload;
  reader.get(payload);
  if (!reader.at_end())
    throw Error(ErrorCode::state_damaged, fmt::format("the state has bytes left over at its end; {}", kRemedy));
  if (checksum(layout, payload) != expected)
    throw Error(ErrorCode::state_damaged,
                fmt::format("the state of {} is damaged: its checksum is wrong; {}", identifier, kRemedy));
  SavedState saved;
  state::restore(saved, payload);
  saved.layout = layout;
  return saved;
}

}  // namespace mebots::shell
