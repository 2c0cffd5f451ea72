// SPDX-License-Identifier: Apache-2.0
#include "io/find_fmu.hpp"

#include "base/installation.hpp"
#include "io/config/load_system.hpp"
#include "mebots/input_error.hpp"
#include "run/input_hash.hpp"
#include "test_system.hpp"

#include <fmt/format.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace mebots::master {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Sets MEBOTS_FMU_PATH during the lifetime of this object.
class SearchPath {
 public:
  explicit SearchPath(const std::string& path) { setenv("MEBOTS_FMU_PATH", path.c_str(), 1); }
  ~SearchPath() { unsetenv("MEBOTS_FMU_PATH"); }
  SearchPath(const SearchPath&) = delete;
  SearchPath& operator=(const SearchPath&) = delete;
};

struct FindFmu : testing::Test {
  /// Writes a file in place of an FMU. find_fmu() does not read its content.
  std::filesystem::path file(const std::filesystem::path& name, const std::string& text = "x") {
    const auto path = std::filesystem::canonical(folder.path()) / name;
    std::filesystem::create_directories(path.parent_path());
    test::write_file(path, text);
    return path;
  }

  std::string error_of(const std::string& text) {
    try {
      find_fmu(text, folder.path());
    } catch (const InputError& error) {
      EXPECT_EQ(error.code(), ErrorCode::fmu_not_found);
      return error.what();
    }
    return "no error";
  }

  modeldesc::TemporaryFolder folder{"mebots-test"};
};

TEST_F(FindFmu, NameHasNeitherFolderNorSuffix) {
  for (const auto* name : {"fmu_battery", "a", "näme"}) EXPECT_TRUE(is_fmu_name(name)) << name;
  for (const auto* path : {"", ".", "..", "a.fmu", "./a", "/a", "a/b", "../a.fmu"})
    EXPECT_FALSE(is_fmu_name(path)) << path;
}

TEST_F(FindFmu, NameIsFoundNextToTheConfigThenInTheSearchPathThenNextToTheProgram) {
  const SearchPath search_path((folder.path() / "first").string() + "::" + (folder.path() / "second").string());
  EXPECT_EQ(find_fmu("fmu_motors", folder.path()), std::filesystem::canonical(MEBOTS_FMU_DIR "/fmu_motors.fmu"));
  const auto second = file("second/fmu_motors.fmu");
  EXPECT_EQ(find_fmu("fmu_motors", folder.path()), second);
  const auto first = file("first/fmu_motors.fmu");
  EXPECT_EQ(find_fmu("fmu_motors", folder.path()), first);
  const auto beside = file("fmu_motors.fmu");
  EXPECT_EQ(find_fmu("fmu_motors", folder.path()), beside);
}

TEST_F(FindFmu, PathCountsFromTheConfigAndIsLookedForNowhereElse) {
  const SearchPath search_path((folder.path() / "first").string());
  file("first/a.fmu");
  EXPECT_THAT(error_of("a.fmu"), HasSubstr((folder.path() / "a.fmu").string()));
  const auto a = file("a.fmu");
  EXPECT_EQ(find_fmu("a.fmu", folder.path()), a);
  EXPECT_EQ(find_fmu("first/../a.fmu", folder.path()), a);
  EXPECT_EQ(find_fmu(a.string(), "/nowhere"), a);
}

TEST_F(FindFmu, FileWithoutSuffixIsAPathAsEver) {
  const auto path = file("fmu_motors");
  EXPECT_EQ(find_fmu("fmu_motors", folder.path()), path);
}

TEST_F(FindFmu, ErrorListsThePlacesLookedAtAndTheNearestNames) {
  const SearchPath search_path((folder.path() / "nowhere").string());
  file("my_battery.fmu");
  EXPECT_THAT(
      error_of("my_batery"),
      AllOf(HasSubstr(folder.path().string()), HasSubstr("nowhere (which does not exist)"),
            HasSubstr(data_places("fmus").front().string()), HasSubstr("'my_battery'"), HasSubstr("MEBOTS_FMU_PATH")));
}

TEST_F(FindFmu, RepeatedQueriesAreAnsweredFromTheCache) {
  FmuSearch search(folder.path());
  const auto a = file("a.fmu");
  EXPECT_EQ(search.find("a").path, a);
  EXPECT_THAT(search.find("b").problem, HasSubstr("there is no FMU 'b'"));
  file("b.fmu");
  std::filesystem::remove(a);
  EXPECT_EQ(search.find("a").path, a);
  EXPECT_THAT(search.find("b").problem, HasSubstr("there is no FMU 'b'")) << "a config sees its folders at one time";
}

TEST_F(FindFmu, OnlyTheFirstOfManyThatAreMissingAreComparedWithThoseThatAreThere) {
  FmuSearch search(folder.path());
  file("my_battery.fmu");
  for (int i = 0; i < 20; ++i) {
    EXPECT_THAT(search.find(fmt::format("my_batery{}", i)).problem, HasSubstr("Did you mean 'my_battery'"));
  }
  EXPECT_THAT(search.find("my_batery").problem,
              AllOf(Not(HasSubstr("Did you mean")), HasSubstr("Add folders with your own FMUs to MEBOTS_FMU_PATH.")));
}

TEST_F(FindFmu, OneThatIsThereIsFoundAfterManyThatAreNot) {
  FmuSearch search(folder.path());
  const auto it = file("it.fmu");
  for (int i = 0; i < 25; ++i) EXPECT_NE(search.find(fmt::format("nowhere{}.fmu", i)).problem, "");
  EXPECT_EQ(search.find("it").path, it);
  const auto other = file("other.fmu");
  for (int i = 0; i < 25; ++i) EXPECT_NE(search.find(fmt::format("nowhere{}", i)).problem, "");
  EXPECT_EQ(search.find("other").path, other);
}

TEST_F(FindFmu, HashOfTheInputsIsThatOfTheBytesWhereverTheyWereFound) {
  const auto hash_of = [&](const std::string& fmu) {
    const auto config = folder.path() / "config.json";
    test::write_file(config, R"({"step": 1, "stop_time": 1, "connections": [], "instances": {"a": {"fmu": "it"}}})");
    file(fmu, test::read_file(PROBE_FMU));
    const auto hash = hash_inputs(read_config(config), {}).all;
    std::filesystem::remove(folder.path() / fmu);
    return hash;
  };
  const SearchPath search_path((folder.path() / "elsewhere").string());
  EXPECT_EQ(hash_of("it.fmu"), hash_of("elsewhere/it.fmu"));
}

}  // namespace
}  // namespace mebots::master
