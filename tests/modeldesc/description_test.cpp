// SPDX-License-Identifier: Apache-2.0
#include "description.hpp"
#include "generate.hpp"
#include "mebots/data/mistakes.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/archive.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

namespace mebots::modeldesc {
namespace {

using testing::HasSubstr;
using testing::Not;

class DescriptionTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    const auto file = folder_.path() / name;
    std::ofstream(file) << text;
    return file;
  }

  Description read(const std::string& variables, const std::string& more = "") {
    return read_description(write("description.json", R"({"name": "x", "text": "An x", "namespace": "a::x", "step": 0.1,
      "stop_time": 1, )" + more + R"("variables": [)" + variables +
                                                          "]}"));
  }

  std::string error_of(const std::string& variables, const std::string& more = "") {
    try {
      read(variables, more);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  TemporaryFolder folder_{"description"};
};

TEST_F(DescriptionTest, NamesCppFieldsAfterTheFmiNameAndTheUnit) {
  const Description x = read(R"(
    {"name": "cell.voltage", "causality": "output", "unit": "V", "text": "t"},
    {"name": "rotor[1].speed", "causality": "output", "unit": "rad/s", "text": "t"},
    {"name": "ratio", "causality": "output", "unit": "1", "text": "t"},
    {"name": "{load}.power", "causality": "input", "unit": "W", "start": 0, "text": "t"},
    {"name": "p.{axis}", "causality": "input", "unit": "m", "start": [1, 2], "text": "t"})",
                             R"("groups": {"load": ["soc", "camera"], "axis": ["x", "y"]}, )");
  ASSERT_EQ(x.fields.size(), 5U);
  EXPECT_EQ(x.fields[0].cpp_name, "cell_voltage_v");
  EXPECT_EQ(x.fields[1].cpp_name, "rotor_1_speed_rad_per_s");
  EXPECT_EQ(x.fields[2].cpp_name, "ratio");
  EXPECT_EQ(x.fields[3].cpp_name, "load_power_w");
  EXPECT_THAT(x.fields[3].fmi_names, testing::ElementsAre("soc.power", "camera.power"));
  EXPECT_EQ(x.fields[4].cpp_name, "p_m");
  EXPECT_THAT(x.fields[4].fmi_names, testing::ElementsAre("p.x", "p.y"));
  const std::string header = variables_header(x);
  EXPECT_THAT(header, HasSubstr("std::array<double, 2> load_power_w = {0, 0};"));
  EXPECT_THAT(header, HasSubstr("std::array<double, 2> p_m = {1, 2};"));
  EXPECT_THAT(header, HasSubstr("enum Index : std::size_t { soc, camera };"));
}

TEST_F(DescriptionTest, RefusesNoVariablesKeysThatStandTwiceAndDeepNesting) {
  EXPECT_THAT(error_of(""), HasSubstr("/variables: the list is empty"));
  EXPECT_THAT(error_of("", R"("step": 0.2, )"), HasSubstr("/step: the key 'step' occurs twice"));
  EXPECT_THAT(error_of(std::string(100'000, '[')), HasSubstr("nested more than 100 levels deep"));
}

TEST_F(DescriptionTest, ReportsWhatIsWrongWithAVariable) {
  const auto expect = [this](const std::string& variable, const char* text) {
    EXPECT_THAT(error_of(variable), HasSubstr(text)) << variable;
  };
  expect(R"({"name": "a", "causality": "output", "text": "t"})", "/variables/0: the key 'unit' is missing");
  expect(R"({"name": "a", "causality": "output", "unit": "furlong", "text": "t"})",
         "/variables/0/unit: the unit 'furlong' is unknown");
  expect(R"({"name": "a", "causality": "input", "unit": "V", "text": "t"})", "the key 'start' is missing");
  expect(R"({"name": "a", "causality": "output", "unit": "V"})", "the key 'text' is missing");
  expect(R"({"name": "a", "causality": "outptu", "unit": "V", "text": "t"})",
         "the word 'outptu' is unknown. Did you mean 'output'?");
  expect(R"({"name": "a", "type": "Rael", "causality": "output", "text": "t"})",
         "the type 'Rael' is unknown. Did you mean 'Real'?");
  expect(R"({"name": "a", "causality": "output", "unit": "V", "text": "t", "mni": 0})",
         "the key 'mni' is unknown. Did you mean 'min'?");
  expect(R"({"name": "a", "causality": "output", "unit": "V", "start": 1, "text": "t"})",
         "/start: this key is for parameters and inputs");
  expect(R"({"name": "a", "causality": "input", "unit": "V", "start": -1, "min": 0, "text": "t"})",
         "/start: -1 is below min 0");
  expect(R"({"name": "a", "causality": "input", "unit": "V", "start": 3, "max": 2, "text": "t"})",
         "/start: 3 is above max 2");
  expect(R"({"name": "a", "causality": "input", "unit": "V", "start": 3, "min": 2, "max": 1, "text": "t"})",
         "min 2 is above max 1");
  expect(R"({"name": "a", "causality": "input", "unit": "V", "start": "3", "text": "t"})",
         "a number is expected here, not \"3\"");
  expect(R"({"name": "a", "type": "Integer", "causality": "input", "start": 1.5, "text": "t"})",
         "must be a whole number from -2147483648 to 2147483647");
  expect(R"({"name": "a", "type": "Integer", "causality": "input", "start": 3000000000, "text": "t"})",
         "must be a whole number from -2147483648 to 2147483647");
  expect(R"({"name": "a", "type": "Integer", "unit": "V", "causality": "output", "text": "t"})",
         "/unit: this key is for Real only");
  expect(R"({"name": "a", "type": "Boolean", "causality": "input", "start": 1, "text": "t"})",
         "true or false is expected here");
  expect(
      R"({"name": "a", "type": "Boolean", "variability": "continuous", "causality": "input", "start": true, "text": "t"})",
      "is not possible with");
  expect(R"({"name": "a b", "causality": "output", "unit": "V", "text": "t"})", "is not a structured FMI name");
  expect(R"({"name": "class", "type": "Boolean", "causality": "output", "text": "t"})", "\"class\" is not a C++ name");
  expect(R"({"name": "{g}.a", "causality": "output", "unit": "V", "text": "t"})", "the group 'g' is unknown");
  expect(R"({"name": "a", "causality": "input", "unit": "V", "start": [1, 2], "text": "t"})",
         "2 values for 1 variables");
  expect(R"({"name": "a", "type": "Binary", "causality": "output", "text": "t"})", "the key 'mime_type' is missing");
  expect(R"({"name": "a", "type": "Boolean", "causality": "output", "on_demand": true, "text": "t"})",
         "/on_demand: this key is for String outputs only");
  expect(R"({"name": "a", "causality": "output", "unit": "V", "depends_on": ["b"], "text": "t"})",
         "/depends_on/0: the input 'b' is unknown");
  expect(R"({"name": "a", "causality": "output", "unit": "V", "first_depends_on": ["b"], "text": "t"})",
         "/first_depends_on/0: the input 'b' is unknown");
  expect(R"({"name": "a", "causality": "input", "unit": "V", "start": 0, "first_depends_on": [], "text": "t"})",
         "/first_depends_on: this key is for outputs only");
}

TEST_F(DescriptionTest, RefusesWhatXmlCannotHold) {
  const std::string y = R"({"name": "y", "causality": "output", "unit": "V", "text": "t"})";
  EXPECT_THAT(error_of(R"({"name": "y", "causality": "output", "unit": "V", "text": "\f so far"})"),
              AllOf(HasSubstr("/variables/0/text"), HasSubstr(R"(\u000c)")));
  EXPECT_THAT(error_of(R"({"name": "y", "type": "String", "causality": "parameter", "start": "\u0001", "text": "t"})"),
              HasSubstr("/variables/0/start"));
  EXPECT_THAT(
      error_of(R"({"name": "y", "type": "Binary", "causality": "output", "mime_type": "a\uffff", "text": "t"})"),
      HasSubstr("/variables/0/mime_type"));
  EXPECT_THAT(error_of(y, R"("log_categories": {"a\u001b": "t"}, )"), HasSubstr(R"(\u001b)"));
  EXPECT_EQ(error_of(R"({"name": "y", "causality": "output", "unit": "V", "text": "tab\tand line\n"})"), "no error");
}

TEST_F(DescriptionTest, RefusesTheSameNameTwice) {
  const std::string a = R"({"name": "a.b", "causality": "output", "unit": "V", "text": "t"})";
  EXPECT_THAT(error_of(a + "," + a), HasSubstr("the name a.b is already taken"));
  // The names differ in FMI, but give the same C++ field.
  EXPECT_THAT(error_of(a + R"(, {"name": "a_b", "causality": "output", "unit": "V", "text": "t"})"),
              HasSubstr("the name a_b_v is already taken"));
}

TEST_F(DescriptionTest, ReportsAllMistakesOfOwnFileAndBoardAtOnce) {
  const auto own = write("description.json", R"({"name": "1x", "text": 2, "namespace": "x", "step": 0, "stop_time": 1,
    "variables": [{"name": "a", "causality": "output", "unit": "V/furlong", "text": "t"},
                  {"name": "b", "causality": "input", "unit": "m3/s", "text": "t", "strat": 1}]})");
  const auto board = write("board.json", R"({"devices": [{"variables": [{"name": "c", "type": "Boolean"}]}]})");
  try {
    read_description(own, board);
    FAIL();
  } catch (const data::Mistakes& mistakes) {
    std::vector<std::pair<ErrorCode, std::string>> found;
    for (const auto& mistake : mistakes.list()) {
      found.emplace_back(mistake.code, mistake.place.substr(mistake.place.find(": /") + 2));
    }
    EXPECT_THAT(found, testing::UnorderedElementsAre(std::pair(ErrorCode::invalid_value, "/name"),
                                                     std::pair(ErrorCode::wrong_type, "/text"),
                                                     std::pair(ErrorCode::value_out_of_range, "/step"),
                                                     std::pair(ErrorCode::wrong_unit, "/variables/0/unit"),
                                                     std::pair(ErrorCode::missing_key, "/variables/1"),
                                                     std::pair(ErrorCode::unknown_key, "/variables/1/strat"),
                                                     std::pair(ErrorCode::missing_key, "/devices/0/variables/0"),
                                                     std::pair(ErrorCode::missing_key, "/devices/0/variables/0")));
  }
}

TEST_F(DescriptionTest, TakesProductsOfPowersOfKnownUnits) {
  const Description x = read(R"x({"name": "flow", "causality": "output", "unit": "m3/s", "text": "t"},
    {"name": "gain", "causality": "output", "unit": "rad/(s.V)", "text": "t"})x");
  EXPECT_EQ(x.fields[0].cpp_name, "flow_m3_per_s");
  EXPECT_EQ(x.fields[1].cpp_name, "gain_rad_per_s_v");
  const auto units = to_model_description(x).units;
  ASSERT_EQ(units.size(), 2U);
  EXPECT_EQ(base_unit_text(units[0]), "m3/s");
}

TEST_F(DescriptionTest, ReportsTheLineOfBrokenJson) {
  const auto file = write("broken.json", "{\n  \"name\": \"x\",\n  oops\n}");
  try {
    read_description(file);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("broken.json:3:3: this is not JSON"));
  }
  EXPECT_THROW(read_description(folder_.path() / "missing.json"), Error);
}

TEST_F(DescriptionTest, JoinsTheVariablesOfABoardsDevices) {
  const auto own = write("description.json", R"({"name": "x", "text": "t", "namespace": "x", "step": 1, "stop_time": 1,
    "variables": [{"name": "power", "causality": "output", "unit": "W", "text": "t"}]})");
  const auto board = write("board.json", R"({"name": "b", "devices": [{"name": "camera", "base": "0x0",
    "enumerations": {"Mode": {"on": 1, "off": 0}},
    "variables": [{"name": "mode", "type": "Mode", "causality": "input", "start": 1, "text": "t"}]}]})");
  const Description joined = read_description(own, board);
  ASSERT_EQ(joined.fields.size(), 2U);
  ASSERT_EQ(joined.enumerations.size(), 1U);
  EXPECT_EQ(joined.enumerations[0].items[0].name, "off") << "by value, as the chip has it";
  EXPECT_EQ(joined.fields[1].enumeration, "Mode");
  EXPECT_THAT(variables_header(joined), HasSubstr("Mode mode = Mode::on;"));

  const auto twice = write("twice.json", R"({"devices": [{"name": "gauge",
    "variables": [{"name": "power", "causality": "output", "unit": "W", "text": "t"}]}]})");
  try {
    read_description(own, twice);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/devices/0/variables/0/name: the name power is already taken by"));
    EXPECT_THAT(error.what(), HasSubstr("description.json:2:20: /variables/0/name"));
  }
}

TEST_F(DescriptionTest, KeepsFmiAndTheShellOutOfTheModelsHeader) {
  const Description x = read(R"({"name": "a", "type": "Binary", "causality": "input", "mime_type": "m", "text": "t"})");
  const std::string header = variables_header(x);
  EXPECT_THAT(header, Not(HasSubstr("fmi")));
  EXPECT_THAT(header, Not(HasSubstr("shell")));
  EXPECT_THAT(header, HasSubstr("mebots::fmu::BinaryRef a = {};"));
}

TEST_F(DescriptionTest, GivesAGuidThatFollowsTheContent) {
  const std::string a = R"({"name": "a", "causality": "output", "unit": "V", "text": "t"})";
  const std::string b = R"({"name": "a", "causality": "output", "unit": "V", "text": "other"})";
  EXPECT_EQ(to_model_description(read(a)).guid, to_model_description(read(a)).guid);
  EXPECT_NE(to_model_description(read(a)).guid, to_model_description(read(b)).guid);
  EXPECT_THAT(to_model_description(read(a)).guid,
              testing::MatchesRegex("\\{[0-9a-f]{8}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{12}\\}"));
}

TEST_F(DescriptionTest, ListsEveryOutputInTheModelStructure) {
  const ModelDescription x = to_model_description(read(R"(
    {"name": "u", "causality": "input", "unit": "V", "start": 0, "text": "t"},
    {"name": "y", "causality": "output", "unit": "V", "text": "t"},
    {"name": "through", "causality": "output", "unit": "V", "depends_on": ["u"], "text": "t"},
    {"name": "picture", "type": "Binary", "causality": "output", "mime_type": "m", "text": "t"})"));
  ASSERT_EQ(x.outputs.size(), 5U);
  EXPECT_EQ(x.outputs[0].variable, 1U);
  EXPECT_TRUE(x.outputs[0].dependencies->empty());
  EXPECT_THAT(*x.outputs[1].dependencies, testing::ElementsAre(0U));
  EXPECT_EQ(x.variables[x.outputs[2].variable].name, "picture.base.lo");
  EXPECT_EQ(x.initial_unknowns.size(), 5U);
  EXPECT_FALSE(x.initial_unknowns[0].dependencies.has_value());
}

TEST_F(DescriptionTest, FirstValuesDependOnAllParametersAndOnTheInputsThatAreNamed) {
  const ModelDescription x = to_model_description(read(R"(
    {"name": "u", "causality": "input", "unit": "V", "start": 0, "text": "t"},
    {"name": "p", "causality": "parameter", "unit": "V", "start": 0, "text": "t"},
    {"name": "v", "causality": "input", "unit": "V", "start": 0, "text": "t"},
    {"name": "still", "causality": "output", "unit": "V", "first_depends_on": [], "text": "t"},
    {"name": "first", "causality": "output", "unit": "V", "first_depends_on": ["u"], "text": "t"})"));
  ASSERT_EQ(x.initial_unknowns.size(), 2U);
  EXPECT_THAT(*x.initial_unknowns[0].dependencies, testing::ElementsAre(1U));
  EXPECT_THAT(*x.initial_unknowns[1].dependencies, testing::ElementsAre(0U, 1U));
  EXPECT_TRUE(x.outputs[1].dependencies->empty());
}

}  // namespace
}  // namespace mebots::modeldesc
