// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"
#include "scene/scene.hpp"

#include <fmt/format.h>
#include <optional>
#include <string_view>

namespace mebots::world {

/// Returns the data of an optional sensor. Throws mebots::Error if the section is not in the drone's file.
template <typename Data>
const Data& described(const std::optional<Data>& data, const scene::Drone& drone, std::string_view section) {
  if (data) return *data;
  throw Error(fmt::format("{0}.enabled needs {0} in the drone file of \"{1}\"; add it or leave the parameter out",
                          section, drone.name));
}

}  // namespace mebots::world
