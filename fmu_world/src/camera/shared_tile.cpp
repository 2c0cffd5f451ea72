// SPDX-License-Identifier: Apache-2.0
#include "camera/tile.hpp"

#include <mutex>
#include <utility>
#include <vector>

namespace mebots::world::camera {
namespace {

/// Tiles in use. They never change, so whoever shares one sees what it would have drawn itself.
class TilesInUse {
 public:
  std::shared_ptr<const Tile> get(const scene::Texture& texture) {
    const std::lock_guard lock(mutex_);
    std::erase_if(tiles_, [](const auto& entry) { return entry.second.expired(); });
    for (const auto& [known, tile] : tiles_) {
      if (auto shared = known == texture ? tile.lock() : nullptr) return shared;
    }
    auto tile = std::make_shared<const Tile>(make_tile(texture));
    tiles_.emplace_back(texture, tile);
    return tile;
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<scene::Texture, std::weak_ptr<const Tile>>> tiles_;
};

}  // namespace

std::shared_ptr<const Tile> shared_tile(const scene::Texture& texture) {
  static TilesInUse tiles;
  return tiles.get(texture);
}

}  // namespace mebots::world::camera
