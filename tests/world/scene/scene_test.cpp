// SPDX-License-Identifier: Apache-2.0
#include "mebots/error.hpp"
#include "scene/load.hpp"

#include <gmock/gmock.h>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace mebots::world::scene {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

const fs::path kParams = fs::path(MEBOTS_SOURCE_DIR) / "fmu_world/params";

json parsed(const fs::path& file) {
  std::ifstream stream(file);
  return json::parse(stream);
}

/// Copies the shipped files. Each test changes one of the copies.
class SceneFile : public testing::Test {
 protected:
  SceneFile()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("mebots_scene_") + testing::UnitTest::GetInstance()->current_test_info()->name())),
        scene(parsed(kParams / "scenes/gate_easy.json")),
        drone(parsed(kParams / "drones/crazyflie.json")) {
    fs::create_directories(folder_);
    scene["drone"] = "drone.json";
  }
  ~SceneFile() override { fs::remove_all(folder_); }

  Scene load() {
    std::ofstream(folder_ / "scene.json") << scene;
    std::ofstream(folder_ / "drone.json") << drone;
    return load_scene(folder_ / "scene.json");
  }
  std::string message() {
    try {
      load();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_;
  json scene;
  json drone;
};

TEST_F(SceneFile, AMissingFileIsNamedWithTheFolderThatItsPathIsRelativeTo) {
  scene["drone"] = "../drones/crazyflie.json";
  EXPECT_THAT(message(), HasSubstr("there is no file '../drones/crazyflie.json': the path is relative to the folder of "
                                   "this file, " +
                                   fs::absolute(folder_).lexically_normal().string()));
}

TEST_F(SceneFile, IsReadUnchanged) {
  const Scene read = load();
  EXPECT_EQ(read.gates.size(), 1U);
  EXPECT_EQ(read.boxes.size(), 4U);
  EXPECT_EQ(read.drone.body_size_m, Eigen::Vector3d(0.092, 0.092, 0.029));
  EXPECT_NEAR(read.lighting.to_sun_W.norm(), 1.0, 1e-15);
  EXPECT_EQ(read.ground.texture.kind, Texture::Kind::checker);
}

TEST(ShippedScenes, AllLoad) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kParams / "scenes")) {
    EXPECT_EQ(load_scene(entry.path()).name, entry.path().stem().string());
    ++count;
  }
  EXPECT_GE(count, 3);
}

TEST_F(SceneFile, RefusesAMissingKey) {
  scene["gates"][0].erase("opening_lower_edge");
  EXPECT_THAT(message(),
              AllOf(HasSubstr("scene.json"), HasSubstr("/gates/0: the key 'opening_lower_edge' is missing")));
}

TEST_F(SceneFile, RefusesAMisspeltKey) {
  scene["gates"][0]["iner"] = 0.5;
  EXPECT_THAT(message(), AllOf(HasSubstr("/gates/0/iner"), HasSubstr("Did you mean 'inner'")));
}

TEST_F(SceneFile, RefusesSizesThatAreNotPositive) {
  scene["boxes"][1]["size"] = {1.0, 0.0, 3.0};
  EXPECT_THAT(message(), AllOf(HasSubstr("/boxes/1/size/1: 0"), HasSubstr("> 0")));
}

TEST_F(SceneFile, RefusesAGateWhoseFrameIsInside) {
  scene["gates"][0]["outer"] = 0.3;
  EXPECT_THAT(message(), HasSubstr("/gates/0/outer: outer = 0.3 must be greater than inner = 0.4"));
}

TEST_F(SceneFile, RefusesAGateBelowTheGround) {
  scene["gates"][0]["opening_lower_edge"] = 0.05;
  EXPECT_THAT(message(), HasSubstr("/gates/0/opening_lower_edge: 0.05 must be >= "));
}

TEST_F(SceneFile, RefusesAnUnknownTexture) {
  scene["ground"]["texture"]["kind"] = "marble";
  EXPECT_THAT(message(), AllOf(HasSubstr("/ground/texture/kind: the word 'marble' is unknown"), HasSubstr("bricks")));
}

TEST_F(SceneFile, RefusesGreysBeyondWhite) {
  scene["ground"]["texture"]["light"] = 256;
  EXPECT_THAT(message(), AllOf(HasSubstr("/ground/texture/light: 256"), HasSubstr("<= 255")));
}

TEST_F(SceneFile, ReportsAllMistakesOfThingsWithLineAndValue) {
  scene["cylinders"] = json::parse(
      R"([{"name": "c", "position": [0, 0, 1], "radius": -1, "height": 1, "texture": {"kind": "uniform", "light": 9}}])");
  scene["meshes"] = json::parse(R"([{"name": "m", "position": [0, 0, 0], "file": "nowhere.glb"}])");
  scene["boxes"][0]["texture"] = json::parse(R"({"kind": "picture", "file": "nowhere.png", "scale": 1})");
  scene["boxes"][1]["path"] =
      json::parse(R"({"points": [{"time": 1, "offset": [0, 0, 0]}, {"time": 1, "offset": [1, 0, 0]}]})");
  scene["terrain"] = json::parse(
      R"({"position": [0, 0], "spacing": 1, "heights": [[0, 1, 2], [0, 1]], "texture": {"kind": "uniform", "light": 9}})");
  const std::string all = message();
  EXPECT_THAT(all, HasSubstr("scene.json:1:"));
  EXPECT_THAT(all, HasSubstr("/cylinders/0/radius: -1"));
  EXPECT_THAT(all, AllOf(HasSubstr("/meshes/0/file: "), HasSubstr("there is no file 'nowhere.glb'")));
  EXPECT_THAT(all, AllOf(HasSubstr("/boxes/0/texture/file: "), HasSubstr("there is no file 'nowhere.png'")));
  EXPECT_THAT(all, HasSubstr("/boxes/1/path/points/0/time: a path begins at time 0"));
  EXPECT_THAT(all, HasSubstr("/boxes/1/path/points/1/time: each time must be greater than the one before"));
  EXPECT_THAT(all, HasSubstr("/terrain/heights/1: this row has 2 numbers, but the first row has 3"));
}

TEST_F(SceneFile, RefusesAPathThatJumpsWhenItRepeats) {
  scene["boxes"][0]["path"] = json::parse(
      R"({"repeat": true, "points": [{"time": 0, "offset": [0, 0, 0]}, {"time": 1, "offset": [1, 0, 0]}]})");
  EXPECT_THAT(message(), HasSubstr("/boxes/0/path/points/1: a path that repeats must end where it begins"));
}

TEST_F(SceneFile, ReadsGatesOfEveryShape) {
  auto& gates = scene["gates"];
  for (int i = 0; i < 3; ++i) gates.push_back(gates[0]);
  gates[1]["shape"] = "rectangle";
  gates[1]["inner"] = {0.8, 0.5};
  gates[1]["outer"] = {1.0, 0.7};
  gates[2]["shape"] = "circle";
  gates[3]["shape"] = "polygon";
  gates[3]["sides"] = 6;
  gates[3]["roll"] = 0.2;
  const Scene read = load();
  EXPECT_DOUBLE_EQ(read.gates[1].p_W_m.z(), 0.83 + 0.25);
  EXPECT_EQ(read.gates[2].side_count(), 32);
  EXPECT_EQ(read.gates[3].side_count(), 6);
  gates[1]["inner"] = {0.8, 0.75};
  gates[3].erase("sides");
  gates[2]["sides"] = 5;
  EXPECT_THAT(message(), AllOf(HasSubstr("/gates/1/outer: outer = 0.7 must be greater than inner = 0.75"),
                               HasSubstr("/gates/2/sides"), HasSubstr("/gates/3: the key 'sides' is missing")));
}

TEST_F(SceneFile, RefusesALightFromNowhere) {
  scene["lighting"]["to_sun"] = {0, 0, 0};
  EXPECT_THAT(message(), HasSubstr("/lighting/to_sun: this must not be the zero vector"));
}

TEST_F(SceneFile, RefusesNegativeFriction) {
  scene["contact"]["friction"] = -0.1;
  EXPECT_THAT(message(), HasSubstr("/contact/friction: -0.1 must be >= 0"));
}

TEST_F(SceneFile, RefusesAListOfTheWrongLength) {
  scene["start"]["position"] = {0, 0};
  EXPECT_THAT(message(), HasSubstr("/start/position: 3 numbers are needed here, not 2"));
}

TEST_F(SceneFile, RefusesTextForANumber) {
  scene["gates"][0]["yaw"] = "east";
  EXPECT_THAT(message(), HasSubstr("/gates/0/yaw: a number is expected here, not \"east\""));
}

TEST_F(SceneFile, RefusesAFractionAsSeed) {
  scene["ground"]["texture"]["seed"] = 1.5;
  EXPECT_THAT(message(), HasSubstr("/ground/texture/seed: 1.5 must be a whole number"));
}

TEST_F(SceneFile, RefusesNegativeMassOfTheDrone) {
  drone["reference_mass"]["value"] = -0.028;
  EXPECT_THAT(message(), AllOf(HasSubstr("drone.json"), HasSubstr("/reference_mass/value: -0.028")));
}

TEST_F(SceneFile, RefusesAnInertiaThatNoBodyHas) {
  drone["inertia"]["values"] = {1e-5, 1e-5, 3e-5};
  EXPECT_THAT(message(), HasSubstr("/inertia: [1e-05, 1e-05, 3e-05] is impossible for a rigid body"));
}

TEST_F(SceneFile, RefusesAnotherUnit) {
  drone["arm"]["unit"] = "mm";
  EXPECT_THAT(message(), HasSubstr("/arm/unit: the unit \"mm\" must be \"m\""));
}

TEST_F(SceneFile, RefusesAThrustCurveThatFalls) {
  drone["thrust_curve"]["thrust"][3] = 0.001;
  EXPECT_THAT(message(), AllOf(HasSubstr("/thrust_curve/thrust/3"), HasSubstr("greater than the value before")));
}

TEST_F(SceneFile, RefusesAFlowSensorWhoseCountsDoNotFit) {
  auto& flow = drone["flow_sensor"];
  flow["resolution"]["value"] = 1e-4;
  EXPECT_THAT(message(), AllOf(HasSubstr("/flow_sensor/resolution"), HasSubstr(">= 0.001")));
  flow["resolution"]["value"] = 1e-3;
  EXPECT_NO_THROW(load());
  flow["pixels_per_rad"]["value"] = 1e9;
  EXPECT_THAT(message(), AllOf(HasSubstr("/flow_sensor/resolution"), HasSubstr("use a coarser resolution")));
}

TEST_F(SceneFile, NamesTheDroneFileThatIsNotThere) {
  scene["drone"] = "nowhere.json";
  EXPECT_THAT(message(), HasSubstr("/drone: there is no file 'nowhere.json'"));
}

TEST(SceneFileText, RefusesWhatIsNotJson) {
  const auto file = fs::path(testing::TempDir()) / "mebots_not_json.json";
  std::ofstream(file) << "{ \"name\": ";
  EXPECT_THAT([&] { load_scene(file); }, ThrowsMessage<Error>(HasSubstr("is not JSON")));
  fs::remove(file);
}

}  // namespace
}  // namespace mebots::world::scene
