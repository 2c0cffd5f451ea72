// SPDX-License-Identifier: Apache-2.0
// The section `pictures`.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {
namespace {

constexpr std::int32_t kLargestPictureWidth = 65536;

PictureDescription read_picture(const Node& node, const SystemDescription& system) {
  Object object(node);
  PictureDescription pictures;
  pictures.place = node.place();
  object.read("frame", pictures.frame, variable_of(system));
  object.read("id", pictures.id, variable_of(system));
  object.read("width", pictures.width,
              [](const Node& width) { return static_cast<std::int32_t>(width.whole_number(1, kLargestPictureWidth)); });
  object.read_if("interval", pictures.interval_ns, &duration_ns);
  object.finish();
  return pictures;
}

}  // namespace

void read_pictures(const Node& node, SystemDescription& system) {
  system.pictures = data::list_of([&](const Node& element) { return read_picture(element, system); })(node);
}

}  // namespace mebots::master::config
