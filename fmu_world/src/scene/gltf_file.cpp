// SPDX-License-Identifier: Apache-2.0
#include "scene/load.hpp"

#include "mebots/error.hpp"
#include "mebots/png_file.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mebots::world::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kDeepest = 64;
/// The greatest number of nodes in a scene. A node counts once per reference, because a small file can reference nodes
/// exponentially often.
constexpr int kMostNodes = 10'000;
/// Greater positions and sizes are rejected, because their unit is probably wrong.
constexpr double kFarthest_m = 1e4;

/// tinygltf calls this function for each picture. Stores the encoded bytes, which are decoded when a material needs the
/// picture.
bool keep_bytes(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
                void*) {
  image->image.assign(bytes, bytes + size);
  return true;
}

/// The numbers of a glTF accessor. They are known to be inside the accessor's buffer.
struct Numbers {
  const unsigned char* first = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;
  int component_type = 0;
  int components = 0;
  bool normalized = false;

  double at(std::size_t element, int component) const {
    const unsigned char* place = first + element * stride;
    const auto read = [&]<typename T>(T) {
      T value;
      std::memcpy(&value, place + sizeof(T) * static_cast<std::size_t>(component), sizeof(T));
      return static_cast<double>(value);
    };
    switch (component_type) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return read(std::uint8_t{}) / (normalized ? 255.0 : 1.0);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return read(std::uint16_t{}) / (normalized ? 65535.0 : 1.0);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return read(std::uint32_t{});
      default:
        return read(float{});
    }
  }
};

class GltfReader {
 public:
  GltfReader(const std::filesystem::path& file, double scale) : file_(file.string()), scale_(scale) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
    if (!stream || bytes.empty()) throw Error(ErrorCode::file_unreadable, fmt::format("{}: cannot be read", file_));
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(&keep_bytes, nullptr);
    const bool binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
    const auto size = static_cast<unsigned>(bytes.size());
    const std::string folder = file.parent_path().string();
    std::string error;
    std::string warning;
    const bool read =
        binary ? loader.LoadBinaryFromMemory(&model_, &error, &warning,
                                             reinterpret_cast<const unsigned char*>(bytes.data()), size, folder)
               : loader.LoadASCIIFromString(&model_, &error, &warning, bytes.data(), size, folder);
    if (!read) refuse(fmt::format("not a glTF 2.0 file: {}", one_line(error)));
    if (!model_.extensionsRequired.empty()) {
      refuse(fmt::format("it requires the extension {}, which is not supported; export the file without it",
                         model_.extensionsRequired.front()));
    }
  }

  Mesh mesh() {
    if (model_.scenes.empty()) refuse("it has no scene");
    const int chosen = model_.defaultScene < 0 ? 0 : model_.defaultScene;
    for (const int node : at(model_.scenes, chosen, "scene").nodes) add_node(node, Eigen::Affine3d::Identity(), 0);
    if (mesh_.triangles.empty()) refuse("there is no triangle in its scene");
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::invalid_value, fmt::format("{}: {}", file_, what));
  }

  static std::string one_line(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.empty() ? "it cannot be parsed" : text;
  }

  template <typename T>
  const T& at(const std::vector<T>& list, int index, const char* what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size()) {
      refuse(fmt::format("it refers to {} {} of {}", what, index, list.size()));
    }
    return list[static_cast<std::size_t>(index)];
  }

  Eigen::Affine3d transform_of(const tinygltf::Node& node) const {
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    if (node.matrix.size() == 16) {
      transform.matrix() = Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
    } else {
      if (node.translation.size() == 3)
        transform.translate(Vector3d(Eigen::Map<const Vector3d>(node.translation.data())));
      if (node.rotation.size() == 4) {
        const auto& q = node.rotation;
        transform.rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized());
      }
      if (node.scale.size() == 3) transform.scale(Vector3d(Eigen::Map<const Vector3d>(node.scale.data())));
    }
    if (!transform.matrix().allFinite())
      refuse(fmt::format("the transformation of node \"{}\" is not finite", node.name));
    return transform;
  }

  void add_node(int index, const Eigen::Affine3d& parent, int depth) {
    if (++nodes_ > kMostNodes) refuse(fmt::format("more than {} nodes, or a cycle in the node hierarchy", kMostNodes));
    if (depth > kDeepest) refuse(fmt::format("its nodes are nested more than {} deep", kDeepest));
    const tinygltf::Node& node = at(model_.nodes, index, "node");
    const Eigen::Affine3d transform = parent * transform_of(node);
    if (node.mesh >= 0) {
      for (const auto& primitive : at(model_.meshes, node.mesh, "mesh").primitives) add_primitive(primitive, transform);
    }
    for (const int child : node.children) add_node(child, transform, depth + 1);
  }

  Numbers numbers(int index, int components, std::initializer_list<int> types, const char* what) const {
    const tinygltf::Accessor& accessor = at(model_.accessors, index, "accessor");
    if (accessor.sparse.isSparse)
      refuse(fmt::format("accessor {} is sparse; export the file without sparse accessors", index));
    const int found = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    if (found != components || std::find(types.begin(), types.end(), accessor.componentType) == types.end()) {
      refuse(fmt::format("accessor {} is not of a type that {} have", index, what));
    }
    const tinygltf::BufferView& view = at(model_.bufferViews, accessor.bufferView, "buffer view");
    const tinygltf::Buffer& buffer = at(model_.buffers, view.buffer, "buffer");
    const auto component_bytes =
        static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
    const std::size_t element = component_bytes * static_cast<std::size_t>(components);
    const std::size_t stride = view.byteStride == 0 ? element : view.byteStride;
    const std::size_t size = buffer.data.size();
    const std::size_t start = view.byteOffset + accessor.byteOffset;
    const bool inside =
        view.byteOffset <= size && view.byteLength <= size - view.byteOffset &&
        accessor.byteOffset <= view.byteLength && stride >= element && stride <= 252 + element &&
        (accessor.count == 0 || (element <= view.byteLength - accessor.byteOffset &&
                                 accessor.count - 1 <= (view.byteLength - accessor.byteOffset - element) / stride));
    if (!inside) refuse(fmt::format("accessor {} reaches beyond its buffer", index));
    return {buffer.data.data() + start, accessor.count, stride,
            accessor.componentType,     components,     accessor.normalized};
  }

  void add_primitive(const tinygltf::Primitive& primitive, const Eigen::Affine3d& transform) {
    if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != -1) {
      refuse(fmt::format("a primitive of mode {}; only triangles (4) are supported", primitive.mode));
    }
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) refuse("a primitive without POSITION");
    const Numbers places = numbers(position->second, 3, {TINYGLTF_COMPONENT_TYPE_FLOAT}, "positions");
    const auto first = static_cast<std::uint32_t>(mesh_.points_m.size());
    for (std::size_t i = 0; i < places.count; ++i)
      add_point(transform * Vector3d(places.at(i, 0), places.at(i, 1), places.at(i, 2)));

    Numbers tiles;
    if (const auto found = primitive.attributes.find("TEXCOORD_0"); found != primitive.attributes.end()) {
      tiles = numbers(found->second, 2,
                      {TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                       TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT},
                      "texture coordinates");
      if (tiles.count != places.count) refuse("a primitive has more positions than texture coordinates, or fewer");
    }
    Numbers indices;
    if (primitive.indices >= 0) {
      indices = numbers(primitive.indices, 1,
                        {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                         TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT},
                        "indices");
    }
    const std::size_t count = primitive.indices >= 0 ? indices.count : places.count;
    const std::uint32_t material = material_of(primitive.material);
    const bool both_sides = primitive.material >= 0 && at(model_.materials, primitive.material, "material").doubleSided;
    const bool mirrored = transform.linear().determinant() < 0.0;
    for (std::size_t i = 0; i + 2 < count; i += 3) {
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        const double index = primitive.indices >= 0 ? indices.at(i + k, 0) : static_cast<double>(i + k);
        if (index >= static_cast<double>(places.count))
          refuse(fmt::format("an index of {} for {} positions", index, places.count));
        corners[k] = static_cast<std::uint32_t>(index);
      }
      if (mirrored) std::swap(corners[1], corners[2]);
      add_triangle(corners, first, material, tiles);
      if (!both_sides) continue;
      std::swap(corners[1], corners[2]);
      add_triangle(corners, first, material, tiles);
    }
  }

  void add_point(const Vector3d& p) {
    const Vector3d ours = scale_ * Vector3d(p.z(), p.x(), p.y());
    if (!ours.allFinite() || ours.norm() > kFarthest_m) {
      refuse(fmt::format("a point lies more than {} m from the origin; is 'scale' right?", kFarthest_m));
    }
    mesh_.points_m.push_back(ours);
  }

  void add_triangle(const std::array<std::uint32_t, 3>& corners, std::uint32_t first, std::uint32_t material,
                    const Numbers& tiles) {
    if (mesh_.triangles.size() >= kMostTriangles) refuse(fmt::format("more than {} triangles", kMostTriangles));
    Mesh::Triangle triangle{{first + corners[0], first + corners[1], first + corners[2]}, material, {}};
    if (mesh_.normal(triangle).isZero()) return;  // lines and points have no area
    if (tiles.count > 0) {
      triangle.tiles.emplace();
      for (std::size_t k = 0; k < 3; ++k) {
        // In glTF, v is measured downwards from the picture's upper edge.
        (*triangle.tiles)[k] = Vector2d(tiles.at(corners[k], 0), 1.0 - tiles.at(corners[k], 1));
        if (!(*triangle.tiles)[k].allFinite()) refuse("a texture coordinate is not a number");
      }
    }
    mesh_.triangles.push_back(triangle);
  }

  /// Returns the index of a material in the mesh. Adds the material if it is new: its base colour, multiplied by its
  /// picture.
  std::uint32_t material_of(int index) {
    for (const auto& [known, place] : materials_) {
      if (known == index) return place;
    }
    Texture texture;
    texture.light = 200.0;
    if (index >= 0) {
      const auto& base = at(model_.materials, index, "material").pbrMetallicRoughness;
      texture.light = base.baseColorFactor.size() >= 3 ? grey_of(base.baseColorFactor) : 255.0;
      if (base.baseColorTexture.index >= 0) {
        const int source = at(model_.textures, base.baseColorTexture.index, "texture").source;
        const tinygltf::Image& image = at(model_.images, source, "image");
        texture.kind = Texture::Kind::picture;
        texture.dark = 0.0;
        texture.scale_m = 1.0;
        texture.picture =
            std::make_shared<const Picture>(decode_png(image.image, fmt::format("{}: image {}", file_, source)));
      }
    }
    const auto place = static_cast<std::uint32_t>(mesh_.materials.size());
    mesh_.materials.push_back(texture);
    materials_.emplace_back(index, place);
    return place;
  }

  /// Returns the relative luminance (ITU-R BT.709) of a linear colour, encoded as sRGB.
  double grey_of(const std::vector<double>& rgb) const {
    const double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    if (!(y >= 0.0 && y <= 1.0)) refuse("a base colour outside of 0..1");
    return 255.0 * (y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1.0 / 2.4) - 0.055);
  }

  std::string file_;
  double scale_;
  tinygltf::Model model_;
  Mesh mesh_;
  int nodes_ = 0;
  std::vector<std::pair<int, std::uint32_t>> materials_;  // index in the file, and index in the mesh
};

}  // namespace

Mesh read_gltf(const std::filesystem::path& file, double scale) {
  return GltfReader(file, scale).mesh();
}

}  // namespace mebots::world::scene
