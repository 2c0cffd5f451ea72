// SPDX-License-Identifier: Apache-2.0
#include "camera/tile.hpp"

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace mebots::world::camera {
namespace {

/// The tiles in use. All worlds share tiles, because drawing them takes most of the time of a world's start.
class Tiles {
 public:
  std::shared_ptr<const Tile> get(const scene::Texture& texture) {
    if (auto tile = find(texture)) return tile;
    std::shared_ptr<const Tile> tile(std::make_unique<const Tile>(make_tile(texture)).release(),
                                     [this](const Tile* gone) {
                                       remove_unused();
                                       std::default_delete<const Tile>()(gone);
                                     });
    const std::lock_guard lock(mutex_);
    used_.emplace_back(texture, tile);
    return tile;
  }

 private:
  std::shared_ptr<const Tile> find(const scene::Texture& texture) {
    const std::lock_guard lock(mutex_);
    for (const auto& [known, tile] : used_) {
      if (known != texture) continue;
      if (auto found = tile.lock()) return found;
    }
    return nullptr;
  }

  /// If no tile is in use, releases all memory. The library's memory is then the same as directly after loading.
  void remove_unused() {
    const std::lock_guard lock(mutex_);
    std::erase_if(used_, [](const auto& entry) { return entry.second.expired(); });
    if (used_.empty()) used_ = decltype(used_)();
  }

  std::mutex mutex_;
  std::vector<std::pair<scene::Texture, std::weak_ptr<const Tile>>> used_;
};

Tiles tiles;

}  // namespace

std::shared_ptr<const Tile> shared_tile(const scene::Texture& texture) {
  return tiles.get(texture);
}

}  // namespace mebots::world::camera
