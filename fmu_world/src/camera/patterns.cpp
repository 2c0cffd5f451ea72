// SPDX-License-Identifier: Apache-2.0
#include "camera/tile.hpp"
#include "mebots/error.hpp"
#include "noise/counter_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace mebots::world::camera {
namespace {

using scene::Texture;

constexpr int kCheckerTexelsPerSquare = 64;
constexpr int kNoiseCells = 16;  // lattice cells along a tile's edge
constexpr int kNoiseTexels = 256;
constexpr int kNoiseOctaves = 3;  // each with half the amplitude and twice the frequency of the one before
constexpr int kBrickRows = 8;     // rows in a tile, and half bricks along its edge
constexpr int kBrickTexels = 256;
constexpr int kMostPictureTexels = 512;  // along a tile's edge: 4 MB
constexpr double kBrickJoint = 0.125;    // width of a joint over the height of a row
constexpr double kBrickSpread = 0.12;    // largest difference of a brick's grey level, relative

/// Returns a uniform number in [0, 1) for a lattice point.
double lattice(std::uint32_t seed, int layer, int x, int y) {
  const std::uint64_t key = noise::hashed((static_cast<std::uint64_t>(seed) << 32) + static_cast<std::uint32_t>(layer));
  const std::uint64_t point =
      (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32) + static_cast<std::uint32_t>(y);
  return static_cast<double>(noise::hashed(key ^ point) >> 11) * 0x1p-53;
}

double smooth(double t) {
  return t * t * (3.0 - 2.0 * t);
}

/// Value noise in [0, 1) with a period of `cells` lattice cells.
class ValueNoise {
 public:
  ValueNoise(std::uint32_t seed, int layer, int cells) : cells_(cells), lattice_(std::size_t{1} * cells * cells) {
    for (int y = 0; y < cells; ++y) {
      for (int x = 0; x < cells; ++x) lattice_[index_of(x, y)] = lattice(seed, layer, x, y);
    }
  }

  double at(double u, double v) const {
    const double x = u * cells_;
    const double y = v * cells_;
    const int x0 = static_cast<int>(x);
    const int y0 = static_cast<int>(y);
    const double fx = smooth(x - x0);
    const double fy = smooth(y - y0);
    const int x1 = (x0 + 1) % cells_;
    const int y1 = (y0 + 1) % cells_;
    const double upper = std::lerp(lattice_[index_of(x0, y0)], lattice_[index_of(x1, y0)], fx);
    const double lower = std::lerp(lattice_[index_of(x0, y1)], lattice_[index_of(x1, y1)], fx);
    return std::lerp(upper, lower, fy);
  }

 private:
  std::size_t index_of(int x, int y) const { return static_cast<std::size_t>(y) * cells_ + x; }

  int cells_;
  std::vector<double> lattice_;
};

class LayeredNoise {
 public:
  explicit LayeredNoise(std::uint32_t seed) {
    for (int octave = 0; octave < kNoiseOctaves; ++octave) {
      octaves_.emplace_back(seed, octave, kNoiseCells << octave);
    }
  }

  double at(double u, double v) const {
    double sum = 0.0;
    double total = 0.0;
    for (int octave = 0; octave < kNoiseOctaves; ++octave) {
      const double amplitude = 1.0 / (1 << octave);
      sum += amplitude * octaves_[octave].at(u, v);
      total += amplitude;
    }
    return sum / total;
  }

 private:
  std::vector<ValueNoise> octaves_;
};

double bricks(const Texture& texture, double u, double v) {
  const double y = v * kBrickRows;
  const int row = static_cast<int>(y);
  const double x = u * kBrickRows / 2 + 0.5 * (row % 2);
  const int column = static_cast<int>(x);
  const double from_bed = y - row;
  const double from_side = 2.0 * (x - column);
  if (from_bed < kBrickJoint || from_side < kBrickJoint) return texture.dark;
  const double shade = 2.0 * lattice(texture.seed, 0, column % (kBrickRows / 2), row) - 1.0;
  return std::clamp(texture.light * (1.0 + kBrickSpread * shade), 0.0, 255.0);
}

/// Interpolates between the centres of a picture's pixels. The picture repeats.
double between_pixels(const scene::Picture& picture, double u, double v) {
  const double x = u * picture.width - 0.5;
  const double y = (1.0 - v) * picture.height - 0.5;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const auto grey = [&](int column, int row) {
    const int wrapped_column = (column + picture.width) % picture.width;
    const int wrapped_row = (row + picture.height) % picture.height;
    return static_cast<double>(picture.grey[static_cast<std::size_t>(wrapped_row) * picture.width + wrapped_column]);
  };
  return std::lerp(std::lerp(grey(x0, y0), grey(x0 + 1, y0), x - x0),
                   std::lerp(grey(x0, y0 + 1), grey(x0 + 1, y0 + 1), x - x0), y - y0);
}

Tile picture_tile(const Texture& texture) {
  const scene::Picture& picture = *texture.picture;
  const int longest = std::max(picture.width, picture.height);
  const int size = std::min(static_cast<int>(std::bit_ceil(static_cast<unsigned>(longest))), kMostPictureTexels);
  const int samples = (longest + size - 1) / size;
  return {Ripmap(size, samples,
                 [&](double u, double v) {
                   return std::lerp(texture.dark, texture.light, between_pixels(picture, u, v) / 255.0);
                 }),
          texture.scale_m, texture.scale_m * picture.height / picture.width};
}

Ripmap noise(const Texture& texture) {
  const LayeredNoise layers(texture.seed);
  return {kNoiseTexels, 1, [&](double u, double v) { return std::lerp(texture.dark, texture.light, layers.at(u, v)); }};
}

Tile square(Ripmap ripmap, double edge_m) {
  return {std::move(ripmap), edge_m, edge_m};
}

}  // namespace

Tile make_tile(const Texture& texture) {
  switch (texture.kind) {
    case Texture::Kind::uniform:
      return square(Ripmap(1, 1, [&](double, double) { return texture.light; }), texture.scale_m);
    case Texture::Kind::checker:
      return square(Ripmap(2 * kCheckerTexelsPerSquare, 1,
                           [&](double u, double v) { return (u < 0.5) == (v < 0.5) ? texture.light : texture.dark; }),
                    2.0 * texture.scale_m);
    case Texture::Kind::stripes:
      return square(Ripmap(2 * kCheckerTexelsPerSquare, 1,
                           [&](double u, double) { return u < 0.5 ? texture.light : texture.dark; }),
                    2.0 * texture.scale_m);
    case Texture::Kind::noise:
      return square(noise(texture), kNoiseCells * texture.scale_m);
    case Texture::Kind::bricks:
      return square(Ripmap(kBrickTexels, 2, [&](double u, double v) { return bricks(texture, u, v); }),
                    kBrickRows * texture.scale_m);
    case Texture::Kind::picture:
      return picture_tile(texture);
  }
  throw Error(fmt::format("camera: texture kind {} has no pattern", static_cast<int>(texture.kind)));
}

}  // namespace mebots::world::camera
