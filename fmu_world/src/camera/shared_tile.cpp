// SPDX-License-Identifier: Apache-2.0
#include "camera/tile.hpp"

#include <cstddef>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

namespace mebots::world::camera {
namespace {

/// Tiles in use, and those that were asked for last: drawing them takes most of a world's start, and the next world of
/// the process often wants the same. They never change, so whoever shares one sees what it would have drawn itself.
class Tiles {
 public:
  std::shared_ptr<const Tile> get(const scene::Texture& texture) {
    const std::lock_guard lock(mutex_);
    std::erase_if(known_, [](const auto& entry) { return entry.second.expired(); });
    auto tile = find(texture);
    if (!tile) {
      tile = std::make_shared<const Tile>(make_tile(texture));
      known_.emplace_back(texture, tile);
    }
    keep(tile);
    return tile;
  }

 private:
  std::shared_ptr<const Tile> find(const scene::Texture& texture) const {
    for (const auto& [known, tile] : known_) {
      if (known == texture) return tile.lock();
    }
    return nullptr;
  }

  /// The last one at the back.
  void keep(const std::shared_ptr<const Tile>& tile) {
    if (std::erase(kept_, tile) == 0) kept_bytes_ += tile->ripmap.bytes();
    kept_.push_back(tile);
    while (kept_bytes_ > kMostKeptTileBytes) {
      kept_bytes_ -= kept_.front()->ripmap.bytes();
      kept_.pop_front();
    }
  }

  std::mutex mutex_;
  std::vector<std::pair<scene::Texture, std::weak_ptr<const Tile>>> known_;
  std::deque<std::shared_ptr<const Tile>> kept_;
  std::size_t kept_bytes_ = 0;
};

}  // namespace

std::shared_ptr<const Tile> shared_tile(const scene::Texture& texture) {
  static Tiles tiles;
  return tiles.get(texture);
}

}  // namespace mebots::world::camera
