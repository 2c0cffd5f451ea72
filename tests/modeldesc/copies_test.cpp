// SPDX-License-Identifier: Apache-2.0
// Tests descriptions that serve for two FMUs: with a single copy of an object, and with several copies.
#include "description.hpp"
#include "fmi3_variables.hpp"
#include "generate.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/archive.hpp"

#include <gmock/gmock.h>
#include <pugixml.hpp>

#include <filesystem>
#include <fstream>

namespace mebots::modeldesc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kWorld = R"("groups": {"axis": ["x", "y"], "rotor": ["rotor[1]", "rotor[2]"]},
  "arrays": {"axis": true, "rotor": true}, "repeat": {"drone": "drone.count"}, "variables": [
  {"name": "drone.count", "type": "Integer", "causality": "parameter", "start": 1, "min": 1, "copies": "shared_by_many", "text": "t"},
  {"name": "gravity", "causality": "parameter", "unit": "m/s2", "start": 9.8, "start_of_many": 1.6, "copies": "shared", "text": "t"},
  {"name": "cell.mass", "causality": "input", "unit": "kg", "start": 0, "text": "t"},
  {"name": "{rotor}.thrust", "causality": "input", "unit": "N", "start": [1, 2], "text": "t"},
  {"name": "drone.mass", "causality": "output", "unit": "kg", "first_depends_on": ["cell.mass"], "text": "t"},
  {"name": "drone.position.{axis}", "causality": "output", "unit": "m", "text": "t"}])";

class CopiesTest : public testing::Test {
 protected:
  Description read(const std::string& rest, std::size_t copies) {
    const auto file = folder_.path() / "description.json";
    std::ofstream(file) << R"({"name": "x", "text": "An x", "step": 0.1, "stop_time": 1, )" << rest << "}";
    return read_description(file, {}, copies);
  }
  std::string error_of(const std::string& rest, std::size_t copies) {
    try {
      read(rest, copies);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  static std::vector<std::string> names(const Description& description) {
    std::vector<std::string> result;
    for (const auto& variable : to_model_description(description).variables) result.push_back(variable.name);
    return result;
  }

  TemporaryFolder folder_{"copies"};
};

TEST_F(CopiesTest, OneCopyHasThePlainNames) {
  EXPECT_THAT(names(read(kWorld, 1)), ElementsAre("gravity", "cell.mass", "rotor[1].thrust", "rotor[2].thrust",
                                                  "drone.mass", "drone.position.x", "drone.position.y"));
}

TEST_F(CopiesTest, AnInputOfSeveralCopiesIsAbsentFromAnFmuOfOne) {
  constexpr const char* kDescription =
      R"("groups": {"robot": ["robot[1]", "robot[2]"]}, "repeat": {"drone": "n"}, "variables": [
    {"name": "n", "type": "Integer", "causality": "parameter", "start": 1, "min": 1, "copies": "shared_by_many", "text": "t"},
    {"name": "{robot}.x", "causality": "input", "unit": "m", "start": 0, "copies": "shared_by_many", "text": "t"},
    {"name": "range", "causality": "output", "unit": "m", "first_depends_on": ["{robot}.x"], "text": "t"}])";
  EXPECT_THAT(names(read(kDescription, 1)), ElementsAre("range"));
  EXPECT_THAT(names(read(kDescription, 2)),
              ElementsAre("n", "robot[1].x", "robot[2].x", "drone[1].range", "drone[2].range"));
}

TEST_F(CopiesTest, SeveralCopiesHaveNumberedNames) {
  EXPECT_THAT(names(read(kWorld, 2)),
              ElementsAre("drone.count", "gravity", "drone[1].cell.mass", "drone[2].cell.mass",
                          "drone[1].rotor[1].thrust", "drone[1].rotor[2].thrust", "drone[2].rotor[1].thrust",
                          "drone[2].rotor[2].thrust", "drone[1].mass", "drone[2].mass", "drone[1].position.x",
                          "drone[1].position.y", "drone[2].position.x", "drone[2].position.y"));
}

TEST_F(CopiesTest, SeveralCopiesCanHaveAnotherStartValue) {
  EXPECT_EQ(std::get<double>(to_model_description(read(kWorld, 1)).variables[0].start), 9.8);
  EXPECT_EQ(std::get<double>(to_model_description(read(kWorld, 2)).variables[1].start), 1.6);
  EXPECT_THAT(error_of(R"("variables": [{"name": "g", "causality": "parameter", "unit": "m/s2", "start": 1,
                          "start_of_many": 2, "text": "t"}])",
                       1),
              HasSubstr("/variables/0/start_of_many: this needs the key 'repeat'"));
  EXPECT_THAT(error_of(R"("repeat": {"drone": "n"}, "variables": [
    {"name": "n", "type": "Integer", "causality": "parameter", "start": 1, "min": 1, "copies": "shared_by_many", "text": "t"},
    {"name": "m", "causality": "parameter", "unit": "kg", "start": 1, "start_of_many": 2, "text": "t"}])",
                       2),
              HasSubstr("/variables/1/start_of_many: this is for a variable without a group"));
}

TEST_F(CopiesTest, EachCopyStartsWithTheValuesOfItsGroup) {
  const auto model = to_model_description(read(kWorld, 2));
  EXPECT_EQ(std::get<std::int64_t>(model.variables[0].start), 2);
  EXPECT_EQ(model.variables[0].max, 2.0);
  for (const std::size_t i : {4U, 6U}) {
    EXPECT_EQ(std::get<double>(model.variables[i].start), 1.0);
    EXPECT_EQ(std::get<double>(model.variables[i + 1].start), 2.0);
  }
}

TEST_F(CopiesTest, AnOutputDependsOnTheInputOfItsOwnCopy) {
  const auto model = to_model_description(read(kWorld, 2));
  const auto& second = model.initial_unknowns[1];
  ASSERT_EQ(model.variables[second.variable].name, "drone[2].mass");
  ASSERT_TRUE(second.dependencies.has_value());
  EXPECT_THAT(*second.dependencies, ElementsAre(0, 1, 3));  // both parameters, drone[2].cell.mass
}

TEST_F(CopiesTest, Fmi3HasArraysOverTheCopiesWhoseNumberIsAStructuralParameter) {
  const auto description = read(kWorld, 3);
  pugi::xml_document document;
  document.load_string(write_fmi3_xml(description, to_model_description(description)).xml.c_str());
  const auto variables = document.document_element().child("ModelVariables");
  const auto count = variables.find_child_by_attribute("name", "drone.count");
  EXPECT_STREQ(count.name(), "UInt64");
  EXPECT_STREQ(count.attribute("causality").value(), "structuralParameter");
  const auto thrust = variables.find_child_by_attribute("name", "drone.rotor.thrust");
  EXPECT_STREQ(thrust.attribute("start").value(), "1 2 1 2 1 2");
  std::vector<std::string> dimensions;
  for (const auto dimension : thrust.children("Dimension")) {
    dimensions.push_back(std::string(dimension.attribute("valueReference").value()) +
                         dimension.attribute("start").value());
  }
  EXPECT_THAT(dimensions, ElementsAre(count.attribute("valueReference").value(), "2"));
  EXPECT_TRUE(variables.find_child_by_attribute("name", "drone.cell.mass"));
}

TEST_F(CopiesTest, TheStructsAreTheSameForEveryNumber) {
  EXPECT_EQ(variables_header(read(kWorld, 1)), variables_header(read(kWorld, 5)));
  EXPECT_THAT(binding_header(read(kWorld, 5)), HasSubstr("using Variables = VariablesOf<5>;"));
}

TEST_F(CopiesTest, NamesWhatIsWrong) {
  const std::string variable = R"("variables": [{"name": "a", "causality": "output", "unit": "m", "text": "t"}])";
  EXPECT_THAT(error_of(variable, 2), HasSubstr("the description repeats nothing"));
  EXPECT_THAT(error_of(R"("repeat": {"drone": "n"}, )" + variable, 1), HasSubstr("the parameter"));
  EXPECT_THAT(error_of(R"("repeat": {}, )" + variable, 1), HasSubstr("name one object to repeat"));
  EXPECT_THAT(
      error_of(R"("variables": [{"name": "a", "causality": "output", "unit": "m", "copies": "shared", "text": "t"}])",
               1),
      HasSubstr("this needs the key 'repeat'"));
  EXPECT_THAT(error_of(R"("repeat": {"drone": "n"}, "variables": [
    {"name": "n", "type": "Integer", "causality": "parameter", "start": 1, "min": 1, "copies": "shared_by_many", "text": "t"},
    {"name": "drone.mass", "causality": "output", "unit": "kg", "text": "t"},
    {"name": "mass", "causality": "output", "unit": "kg", "text": "t"}])",
                       2),
              HasSubstr("two variables have the name drone[1].mass"));
}

}  // namespace
}  // namespace mebots::modeldesc
