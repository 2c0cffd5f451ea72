// SPDX-License-Identifier: Apache-2.0
#include "fmi/fmu.hpp"
#include "mebots/input_error.hpp"
#include "slave/fmi/fmi2_slave.hpp"
#include "test_system.hpp"

#include <gmock/gmock.h>

#include <functional>

namespace mebots::master {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A copy of the probe FMU with a changed description and, if given, another library.
class ChangedProbe {
 public:
  explicit ChangedProbe(const std::function<void(std::string&)>& change,
                        const std::filesystem::path& library = PROBE_LIBRARY) {
    auto xml = test::read_file(PROBE_DESCRIPTION);
    change(xml);
    test::write_file(folder_.path() / "modelDescription.xml", xml);
    std::vector<modeldesc::PackedFile> files = {{"modelDescription.xml", folder_.path() / "modelDescription.xml"}};
    if (!library.empty()) files.push_back({"binaries/linux64/probe.so", library});
    if (library.empty()) files.push_back({"binaries/win64/probe.dll", PROBE_LIBRARY});
    modeldesc::pack(path(), files);
  }

  std::filesystem::path path() const { return folder_.path() / "changed.fmu"; }

 private:
  modeldesc::TemporaryFolder folder_{"mebots-test"};
};

void replace(std::string& text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

std::string load_error(const std::filesystem::path& archive) {
  return test::input_error([&] { Fmu(archive).require_library(); });
}

TEST(Fmu, AFileThatIsNoArchiveIsRefused) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "text.fmu", "this is not a zip archive");
  EXPECT_THAT(load_error(folder.path() / "text.fmu"), HasSubstr("text.fmu"));
}

TEST(Fmu, ATruncatedArchiveIsRefused) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto bytes = test::read_file(PROBE_FMU);
  for (const auto part : {std::size_t{0}, bytes.size() / 4, bytes.size() / 2, bytes.size() - 1}) {
    test::write_file(folder.path() / "cut.fmu", bytes.substr(0, part));
    EXPECT_THAT(load_error(folder.path() / "cut.fmu"), HasSubstr("cut.fmu")) << part;
  }
}

TEST(Fmu, AnArchiveWithoutDescriptionIsRefused) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  modeldesc::pack(folder.path() / "empty.fmu", {{"readme", PROBE_DESCRIPTION}});
  EXPECT_THAT(load_error(folder.path() / "empty.fmu"), HasSubstr("no modelDescription.xml"));
}

TEST(Fmu, ABinaryForAnotherPlatformOnlyIsNamed) {
  const ChangedProbe probe([](std::string&) {}, {});
  setenv("MEBOTS_WINE", "/nowhere", 1);
  EXPECT_THAT(load_error(probe.path()), AllOf(HasSubstr("no binary for x86-64 Linux"), HasSubstr("win64"),
                                              HasSubstr("Set MEBOTS_WINE"), HasSubstr("/nowhere")));
  unsetenv("MEBOTS_WINE");
}

TEST(Fmu, NamesAFileThatIsNotALibrary) {
  const ChangedProbe probe([](std::string&) {}, PROBE_DESCRIPTION);
  EXPECT_THAT(load_error(probe.path()), AllOf(HasSubstr("cannot be loaded"), HasSubstr("probe.so")));
}

TEST(Fmu, MissingFunctionsAreListed) {
  const ChangedProbe probe([](std::string&) {}, "/lib/x86_64-linux-gnu/libz.so.1");
  if (!std::filesystem::exists("/lib/x86_64-linux-gnu/libz.so.1"))
    GTEST_SKIP() << "needs some library that is not an FMU";
  EXPECT_THAT(load_error(probe.path()),
              AllOf(HasSubstr("lacks functions"), HasSubstr("fmi2DoStep"), HasSubstr("fmi2Instantiate")));
}

TEST(Fmu, AnotherVersionOfFmiIsRefused) {
  const ChangedProbe probe([](std::string& xml) { replace(xml, "fmiVersion=\"2.0\"", "fmiVersion=\"4.0\""); });
  EXPECT_THAT(load_error(probe.path()), HasSubstr("FMI version 4.0; only 1.0, 2.0 and 3.0"));
}

TEST(Fmu, ModelExchangeNeedsItsFunctions) {
  const ChangedProbe probe([](std::string& xml) { replace(xml, "<CoSimulation ", "<ModelExchange "); });
  EXPECT_THAT(load_error(probe.path()), AllOf(HasSubstr("changed.fmu"), HasSubstr("lacks functions"),
                                              HasSubstr("fmi2GetDerivatives"), Not(HasSubstr("fmi2DoStep"))));
}

TEST(Fmu, AWrongGuidIsAnsweredWithTheFmusWords) {
  const ChangedProbe probe([](std::string& xml) { replace(xml, "guid=\"{probe}\"", "guid=\"{other}\""); });
  test::Messages messages;
  try {
    Fmi2Slave slave("x", std::make_shared<Fmu>(probe.path()), {}, messages);
    FAIL() << "the FMU refuses another GUID";
  } catch (const SlaveError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("instance 'x'"), HasSubstr("fmi2Instantiate"),
                                    HasSubstr("the GUID is {other}, not {probe}")));
  }
}

TEST(Fmu, OneInstancePerProcessIsRespected) {
  const ChangedProbe probe([](std::string& xml) {
    replace(xml, "canSerializeFMUstate=\"true\"",
            "canSerializeFMUstate=\"true\" canBeInstantiatedOnlyOncePerProcess=\"true\"");
  });
  const auto path = probe.path().string();
  const auto config = [&](const std::string& keys) {
    return R"({"step": 0.1, "stop_time": 1, "connections": [], "record": ["*.integral"], "instances": {
      "a": {"fmu": ")" +
           path + R"(", "parameters": {"real_in": 1}}, "b": {"fmu": ")" + path + R"(", "parameters": {"real_in": 2})" +
           keys + "}}}";
  };
  test::TestRun run(config(""));
  run.to_end();
  EXPECT_THAT(run.system.notices, testing::Contains(AllOf(HasSubstr("b: "), HasSubstr("its own process"),
                                                          HasSubstr("one instance per process"), HasSubstr("'a'"))));
  EXPECT_NEAR(run.column("a.integral").back(), 1, 1e-12);
  EXPECT_NEAR(run.column("b.integral").back(), 2, 1e-12);
  EXPECT_THAT(test::input_error([&] { test::TestRun(config(R"(, "process": "shared")")); }),
              AllOf(HasSubstr("one instance per process"), HasSubstr("/instances/b/process")));
}

TEST(Fmu, ReportsAnFmuThatCannotSaveItsState) {
  const ChangedProbe probe(
      [](std::string& xml) { replace(xml, "canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"", ""); });
  test::Messages messages;
  Fmi2Slave slave("x", std::make_shared<Fmu>(probe.path()), {}, messages);
  EXPECT_THROW(slave.save_state(), Error);
}

TEST(Fmu, TheUnpackedFolderGoesWithIt) {
  std::filesystem::path folder;
  {
    const Fmu fmu(PROBE_FMU);
    folder = std::filesystem::path(fmu.resource_uri().substr(7)).parent_path();
    EXPECT_TRUE(std::filesystem::exists(folder / "modelDescription.xml"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(Fmu, UnusualCharactersInAUriArePercentEncoded) {
  EXPECT_EQ(file_uri("/tmp/a b%c/ä#?"), "file:///tmp/a%20b%25c/%C3%A4%23%3F");
}

TEST(Fmu, AnArchiveInAFolderOfAnOddNameRuns) {
  test::TestRun run(std::string(R"({"step": 0.1, "stop_time": 1, "connections": [], "instances": {"a": {"fmu": ")") +
                    ODD_FMU + R"("}}})");
  run.to_end();
  EXPECT_EQ(run.column("a.steps").back(), 10);
}

TEST(Fmu, AThousandInstancesOfOneFmuRun) {
  std::string instances;
  for (int i = 0; i < 1000; ++i)
    instances += (i == 0 ? "" : ", ") + ("\"i" + std::to_string(i)) + R"(": {"fmu": "PROBE"})";
  test::TestRun run(R"({"step": 0.1, "stop_time": 0.2, "connections": [], "record": ["*.steps"], "instances": {)" +
                    instances + "}}");
  run.to_end();
  EXPECT_EQ(run.column("i999.steps").back(), 2);
}

}  // namespace
}  // namespace mebots::master
