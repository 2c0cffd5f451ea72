// SPDX-License-Identifier: Apache-2.0
#include "model/picture_size.hpp"

#include <fmt/format.h>

#include <string_view>
#include <variant>

namespace mebots::master {
namespace {

constexpr std::string_view kFrame = "frame";

/// Returns the start value of a parameter of the frame. For the frame `x.frame` and the name "width", this is
/// `x.width`.
std::optional<PictureSide> side(const ResolvedSystem& system, const VariableName& frame, std::string_view name) {
  const auto index = system.description->index_of(frame.instance);
  if (!index || !frame.variable.ends_with(kFrame)) return std::nullopt;
  const auto& instance = system.instances[*index];
  const auto parameter = frame.variable.substr(0, frame.variable.size() - kFrame.size()) + std::string(name);
  const auto* variable = instance.model->find(parameter);
  if (variable == nullptr || variable->causality != modeldesc::Causality::parameter) return std::nullopt;
  auto value = variable->start;
  for (const auto& start : instance.starts) {
    if (start.variable == variable) value = start.value;
  }
  const auto* pixels = std::get_if<std::int64_t>(&value);
  return pixels == nullptr
             ? std::nullopt
             : std::optional(PictureSide{frame.instance + "." + parameter, static_cast<std::int32_t>(*pixels)});
}

}  // namespace

std::optional<PictureSide> picture_width(const ResolvedSystem& system, const VariableName& frame) {
  return side(system, frame, "width");
}

void check_picture_sizes(const ResolvedSystem& system, const ConnectionDescription& connection) {
  for (const std::string name : {"width", "height"}) {
    const auto from = side(system, connection.from, name);
    const auto to = side(system, connection.to, "frame_" + name);
    if (!from || !to || to->pixels == 0 || from->pixels == to->pixels) continue;
    throw InputError(
        ErrorCode::invalid_connection,
        fmt::format("{}: {} -> {}: {} is {} and {} is {}; pictures of another size would be garbled: set both "
                    "to the same",
                    connection.place, connection.from.text(), connection.to.text(), from->parameter, from->pixels,
                    to->parameter, to->pixels));
  }
}

}  // namespace mebots::master
