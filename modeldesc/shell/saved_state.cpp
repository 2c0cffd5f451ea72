// SPDX-License-Identifier: Apache-2.0
#include "saved_state.hpp"

#include "mebots/error.hpp"
#include "mebots/state/bytes.hpp"

#include <fmt/format.h>

#include <string>

namespace mebots::shell {
namespace {

constexpr std::uint64_t kMagic = 0x3153'746F'6245'4D89;  // 0x89 "MEbotS1", read as little endian
constexpr std::uint32_t kFormat = 1;

/// FNV-1a, 64 bits (Fowler, Noll, Vo): finds damage, does not protect from intent.
std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xCBF2'9CE4'8422'2325;
  for (const std::byte byte : bytes) hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x0000'0100'0000'01B3;
  return hash;
}

std::vector<std::byte> payload_of(const SavedState& saved) {
  state::Writer writer;
  writer.put(saved.state);
  writer.put(saved.experiment_is_set);
  writer.put(saved.model_is_stale);
  writer.put(saved.start_ns);
  writer.put(saved.time_ns);
  writer.put(saved.stop_ns.has_value());
  writer.put(saved.stop_ns.value_or(0));
  writer.put(saved.parameters);
  writer.put(saved.inputs);
  writer.put(saved.outputs);
  writer.put(saved.model.has_value());
  if (saved.model) writer.put(*saved.model);
  return writer.take();
}

SavedState from_payload(std::span<const std::byte> payload) {
  state::Reader reader(payload);
  SavedState saved;
  reader.get(saved.state);
  reader.get(saved.experiment_is_set);
  reader.get(saved.model_is_stale);
  reader.get(saved.start_ns);
  reader.get(saved.time_ns);
  const bool has_stop = reader.get<bool>();
  const auto stop_ns = reader.get<std::int64_t>();
  if (has_stop) saved.stop_ns = stop_ns;
  reader.get(saved.parameters);
  reader.get(saved.inputs);
  reader.get(saved.outputs);
  if (reader.get<bool>()) reader.get(saved.model.emplace());
  if (!reader.at_end()) throw Error("a serialised state has bytes left over at its end");
  return saved;
}

}  // namespace

std::vector<std::byte> serialize(const Definition& definition, const SavedState& saved) {
  const std::vector<std::byte> payload = payload_of(saved);
  state::Writer writer;
  writer.put(kMagic);
  writer.put(kFormat);
  writer.put(std::string(definition.model_identifier));
  writer.put(std::string(definition.guid));
  writer.put(checksum(payload));
  writer.put(payload);
  return writer.take();
}

SavedState deserialize(const Definition& definition, std::span<const std::byte> bytes) {
  constexpr const char* kWayOut = "serialise a state of this FMU and version again";
  state::Reader reader(bytes);
  if (bytes.size() < sizeof kMagic || reader.get<std::uint64_t>() != kMagic)
    throw Error(fmt::format("these {} bytes are no state of a MEbots FMU; {}", bytes.size(), kWayOut));
  if (const auto format = reader.get<std::uint32_t>(); format != kFormat)
    throw Error(fmt::format("the state has format {}, this FMU reads format {}; {}", format, kFormat, kWayOut));
  std::string identifier;
  std::string guid;
  reader.get(identifier);
  reader.get(guid);
  if (identifier != definition.model_identifier)
    throw Error(fmt::format("the state belongs to {}, this is {}", identifier, definition.model_identifier));
  if (guid != definition.guid)
    throw Error(fmt::format("the state belongs to {} with GUID {}, this one has {}; {}", identifier, guid,
                            definition.guid, kWayOut));
  const auto expected = reader.get<std::uint64_t>();
  std::vector<std::byte> payload;
  reader.get(payload);
  if (!reader.at_end()) throw Error(fmt::format("the state has bytes left over at its end; {}", kWayOut));
  if (checksum(payload) != expected)
    throw Error(fmt::format("the state of {} is damaged: its checksum does not fit; {}", identifier, kWayOut));
  return from_payload(payload);
}

}  // namespace mebots::shell
