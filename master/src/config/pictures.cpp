// SPDX-License-Identifier: Apache-2.0
// The section `pictures`.
#include "reading.hpp"
#include "sections.hpp"

#include <fmt/format.h>

namespace mebots::master::config {
namespace {

constexpr int kLargestPictureWidth = 65536;

PictureDescription read_picture(const JsonNode& node, const SystemDescription& system) {
  node.expect_keys({"frame", "id", "width", "interval"});
  PictureDescription pictures;
  pictures.place = node.place();
  pictures.frame = variable_name(node.at("frame"), system);
  pictures.id = variable_name(node.at("id"), system);
  const auto width = node.at("width");
  if (!width.value().is_number_integer() || width.number() < 1 || width.number() > kLargestPictureWidth) {
    width.fail(fmt::format("the width must be a whole number of pixels from 1 to {}", kLargestPictureWidth));
  }
  pictures.width = static_cast<std::int32_t>(width.number());
  if (const auto interval = node.find("interval")) pictures.interval_ns = duration_ns(*interval);
  return pictures;
}

}  // namespace

void read_pictures(const JsonNode& node, SystemDescription& system) {
  for (const auto& element : node.elements()) system.pictures.push_back(read_picture(element, system));
}

}  // namespace mebots::master::config
