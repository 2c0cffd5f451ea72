// SPDX-License-Identifier: Apache-2.0
// Tests reading glTF and PNG files of a scene: their content, and messages for errors.
#include "mebots/base64.hpp"
#include "mebots/error.hpp"
#include "mebots/png_file.hpp"
#include "scene/load.hpp"

#include <gmock/gmock.h>
#include <png.h>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace mebots::world::scene {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

std::vector<std::uint8_t> png_of(int width, int height, const std::vector<std::uint8_t>& grey) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<unsigned>(width);
  image.height = static_cast<unsigned>(height);
  image.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&image, nullptr, &size, 0, grey.data(), 0, nullptr);
  std::vector<std::uint8_t> bytes(size);
  png_image_write_to_memory(&image, bytes.data(), &size, 0, grey.data(), 0, nullptr);
  bytes.resize(size);
  return bytes;
}

class MeshFile : public testing::Test {
 protected:
  MeshFile()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("mebots_mesh_") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
    // A triangle: points (x left, y up, z forward), then three indices.
    const std::vector<float> places{0, 0, 0, 1, 0, 0, 0, 2, 3};
    const std::vector<std::uint16_t> corners{0, 1, 2};
    std::vector<std::uint8_t> bytes(places.size() * 4 + corners.size() * 2);
    std::memcpy(bytes.data(), places.data(), places.size() * 4);
    std::memcpy(bytes.data() + places.size() * 4, corners.data(), corners.size() * 2);
    gltf = json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 3]},
                    {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}]})");
    gltf["buffers"] = {
        {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + encode_base64(bytes)}}};
  }
  ~MeshFile() override { fs::remove_all(folder_); }

  Mesh read(double scale = 1.0) {
    std::ofstream(folder_ / "thing.gltf") << gltf;
    return read_gltf(folder_ / "thing.gltf", scale);
  }
  std::string message() {
    try {
      read();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_;
  json gltf;
};

TEST_F(MeshFile, TurnsTheFilesAxesIntoOurs) {
  const Mesh mesh = read(2.0);
  ASSERT_EQ(mesh.points_m.size(), 3U);
  EXPECT_EQ(mesh.points_m[1], Eigen::Vector3d(0, 2, 0));  // their x is left
  EXPECT_EQ(mesh.points_m[2], Eigen::Vector3d(6, 0, 4));  // their y is up, their z forward
  ASSERT_EQ(mesh.triangles.size(), 1U);
  EXPECT_FALSE(mesh.triangles[0].tiles.has_value());
}

TEST_F(MeshFile, PlacesWhatNodesHoldInEachOther) {
  gltf["nodes"] =
      json::parse(R"([{"children": [1], "translation": [0, 0, 10]}, {"mesh": 0, "rotation": [0, 1, 0, 0]}])");
  const Mesh mesh = read();
  // The mesh is rotated by half a turn about the file's y axis, then shifted forward by 10.
  EXPECT_TRUE(mesh.points_m[1].isApprox(Eigen::Vector3d(10, -1, 0), 1e-12)) << mesh.points_m[1].transpose();
  EXPECT_TRUE(mesh.points_m[2].isApprox(Eigen::Vector3d(7, 0, 2), 1e-12)) << mesh.points_m[2].transpose();
}

TEST_F(MeshFile, AMirroredNodeKeepsItsFrontOutside) {
  const Mesh plain = read();
  gltf["nodes"][0]["scale"] = {-1, 1, 1};
  const Mesh mirrored = read();
  const auto normal = plain.normal(plain.triangles[0]);
  const auto other = mirrored.normal(mirrored.triangles[0]);
  EXPECT_NEAR(other.y(), -normal.y(), 1e-12);
  EXPECT_NEAR(other.z(), normal.z(), 1e-12);
}

TEST_F(MeshFile, ColoursBecomeGreysAsPicturesKeepThem) {
  gltf["materials"] =
      json::parse(R"([{"pbrMetallicRoughness": {"baseColorFactor": [0.2158605, 0.2158605, 0.2158605, 1]}}])");
  gltf["meshes"][0]["primitives"][0]["material"] = 0;
  const Mesh mesh = read();
  EXPECT_NEAR(mesh.materials[0].light, 128.0, 0.01);  // the linear light of sRGB 128
}

TEST_F(MeshFile, ShowsBothSidesIfTheFileRequestsIt) {
  gltf["materials"] = json::parse(R"([{"doubleSided": true}])");
  gltf["meshes"][0]["primitives"][0]["material"] = 0;
  const Mesh mesh = read();
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.normal(mesh.triangles[0]), -mesh.normal(mesh.triangles[1]));
}

TEST_F(MeshFile, RefusesWhatItCannotRead) {
  const json good = gltf;
  gltf["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  EXPECT_THAT(message(), AllOf(HasSubstr("thing.gltf"), HasSubstr("KHR_draco_mesh_compression")));
  gltf = good;
  gltf["meshes"][0]["primitives"][0]["mode"] = 1;
  EXPECT_THAT(message(), HasSubstr("mode 1; only triangles (4) are supported"));
  gltf = good;
  gltf["accessors"][0]["count"] = 4;
  EXPECT_THAT(message(), HasSubstr("accessor 0 reaches beyond its buffer"));
  gltf = good;
  gltf["bufferViews"][1]["byteLength"] = 4000;
  EXPECT_THAT(message(), HasSubstr("accessor 1 reaches beyond its buffer"));
  gltf = good;
  gltf["accessors"][1]["count"] = 0;
  EXPECT_THAT(message(), HasSubstr("there is no triangle"));
  gltf = good;
  gltf["nodes"][0]["children"] = {0};
  EXPECT_THAT(message(), HasSubstr("more than 64 deep"));
  gltf = good;
  gltf["nodes"] =
      json::parse(R"([{"children": [1, 1]}, {"children": [2, 2]}, {"children": [3, 3]}, {"children": [0, 0]}])");
  EXPECT_THAT(message(), testing::AnyOf(HasSubstr("a cycle in the node hierarchy"), HasSubstr("more than 64 deep")));
  gltf = good;
  gltf["nodes"][0]["translation"] = {0, 0, 1e6};
  EXPECT_THAT(message(), HasSubstr("is 'scale' right?"));
  gltf = json::array();
  EXPECT_THAT(message(), HasSubstr("not a glTF 2.0 file"));
}

TEST_F(MeshFile, RefusesAnIndexWithoutAPosition) {
  gltf["accessors"][0]["count"] = 2;
  EXPECT_THAT(message(), HasSubstr("an index of 2 for 2 positions"));
}

TEST(PngFile, GivesGreysRowByRowFromTheTop) {
  const std::vector<std::uint8_t> grey{0, 50, 100, 150, 200, 250};
  const Picture picture = decode_png(png_of(3, 2, grey), "p");
  EXPECT_EQ(picture.width, 3);
  EXPECT_EQ(picture.height, 2);
  EXPECT_EQ(picture.grey, grey);
}

TEST(PngFile, RefusesWhatIsDamaged) {
  auto bytes = png_of(3, 2, {0, 50, 100, 150, 200, 250});
  const auto message = [&] {
    try {
      static_cast<void>(decode_png(bytes, "p.png"));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  bytes.resize(bytes.size() / 2);
  EXPECT_THAT(message(), AllOf(HasSubstr("p.png: this cannot be decoded"), HasSubstr("PNG")));
  bytes.assign({'G', 'I', 'F', '8', '9', 'a', 0, 0, 0, 0});
  EXPECT_THAT(message(), HasSubstr("p.png: this cannot be decoded"));
}

}  // namespace
}  // namespace mebots::world::scene
