// SPDX-License-Identifier: Apache-2.0
#include "run/run_request.hpp"

#include <type_traits>

namespace mebots::master {
namespace {

void put_value(state::Writer& writer, const WrittenValue& value) {
  writer.put(static_cast<std::uint64_t>(value.index()));
  std::visit(
      [&]<typename T>(const T& held) {
        if constexpr (std::is_same_v<T, UntypedText>) {
          writer.put(held.text);
        } else {
          writer.put(held);
        }
      },
      value);
}

template <typename T>
T taken(state::Reader& reader) {
  T value{};
  reader.get(value);
  return value;
}

WrittenValue get_value(state::Reader& reader) {
  switch (reader.get<std::uint64_t>()) {
    case 0:
      return taken<double>(reader);
    case 1:
      return taken<std::int64_t>(reader);
    case 2:
      return taken<bool>(reader);
    case 3:
      return taken<std::string>(reader);
    default:
      return UntypedText{taken<std::string>(reader)};
  }
}

template <typename T, typename Put>
void put_optional(state::Writer& writer, const std::optional<T>& value, Put put_one) {
  writer.put(value.has_value());
  if (value) put_one(*value);
}

template <typename T, typename Get>
void get_optional(state::Reader& reader, std::optional<T>& value, Get get_one) {
  if (reader.get<bool>()) value = get_one();
}

template <typename List, typename Put>
void put_list(state::Writer& writer, const List& list, Put put_one) {
  writer.put(static_cast<std::uint64_t>(list.size()));
  for (const auto& element : list) put_one(element);
}

template <typename List, typename Get>
void get_list(state::Reader& reader, List& list, Get get_one) {
  for (auto count = reader.get<std::uint64_t>(); count > 0; --count) list.push_back(get_one());
}

}  // namespace

RunRequest with_absolute_paths(RunRequest request) {
  request.config = std::filesystem::absolute(request.config);
  for (auto& file : request.scenarios) file = std::filesystem::absolute(file);
  if (!request.folder.empty()) request.folder = std::filesystem::absolute(request.folder);
  return request;
}

void put(state::Writer& writer, const RunRequest& request) {
  const auto text = [&](const auto& value) { writer.put(std::string(value)); };
  const auto number = [&](std::int64_t value) { writer.put(value); };
  text(request.config.string());
  put_list(writer, request.settings, [&](const Setting& setting) {
    text(setting.variable);
    put_value(writer, setting.value);
    text(setting.place);
  });
  put_list(writer, request.scenarios, [&](const std::filesystem::path& file) { text(file.string()); });
  put_optional(writer, request.stop_time_ns, number);
  put_optional(writer, request.step_ns, number);
  put_optional(writer, request.record, [&](const auto& patterns) { put_list(writer, patterns, text); });
  text(request.folder.string());
  writer.put(request.in_memory);
  writer.put(request.isolate);
  writer.put(request.statistics);
  number(request.checkpoint_every_ns);
}

RunRequest get_run_request(state::Reader& reader) {
  const auto text = [&] { return taken<std::string>(reader); };
  const auto number = [&] { return taken<std::int64_t>(reader); };
  RunRequest request;
  request.config = text();
  get_list(reader, request.settings, [&] {
    Setting setting;
    setting.variable = text();
    setting.value = get_value(reader);
    setting.place = text();
    return setting;
  });
  get_list(reader, request.scenarios, text);
  get_optional(reader, request.stop_time_ns, number);
  get_optional(reader, request.step_ns, number);
  get_optional(reader, request.record, [&] {
    std::vector<std::string> patterns;
    get_list(reader, patterns, text);
    return patterns;
  });
  request.folder = text();
  reader.get(request.in_memory);
  reader.get(request.isolate);
  reader.get(request.statistics);
  request.checkpoint_every_ns = number();
  return request;
}

}  // namespace mebots::master
