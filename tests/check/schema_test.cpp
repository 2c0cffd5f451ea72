// SPDX-License-Identifier: Apache-2.0
#include "checks.hpp"
#include "support.hpp"

#include <gmock/gmock.h>

namespace mebots::check {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// Returns the findings of the schema checks about culprit.cpp's description with one piece of text replaced.
std::vector<std::string> with(const std::string& piece, const std::string& other) {
  auto text = culprit_description("none");
  const auto at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  text.replace(at, piece.size(), other);
  Report report;
  report.checks.emplace_back();
  check_schema(text, report.checks.back());
  return findings(report);
}

TEST(CheckSchema, PassesEveryFormThatTheStandardAllows) {
  EXPECT_THAT(with("{culprit:", "{culprit:"), IsEmpty());
  EXPECT_THAT(with("max=\"100\"", "max=\"INF\" nominal=\" 1e3 \" quantity=\"Length\""), IsEmpty());
  EXPECT_THAT(with("</ModelVariables>", "<!-- a comment --></ModelVariables>"), IsEmpty());
  EXPECT_THAT(with("<DefaultExperiment", "<DefaultExperiment xmlns:x=\"urn:x\" "), IsEmpty());
  EXPECT_THAT(with("  <ModelVariables>",
                   "<VendorAnnotations><Tool name=\"t\"><any thing=\"1\"/></Tool></VendorAnnotations><ModelVariables>"),
              IsEmpty());
}

TEST(CheckSchema, MistakesAreNamedWithTheirLine) {
  EXPECT_THAT(with("fmiVersion=\"2.0\" ", ""),
              Contains(HasSubstr("line 2, <fmiModelDescription>: the attribute fmiVersion is missing")));
  EXPECT_THAT(with("causality=\"input\"", "causality=\"inward\""), Contains(HasSubstr("causality is \"inward\"")));
  EXPECT_THAT(with("start=\"1\"", "start=\"one\""), Contains(HasSubstr("start is \"one\"")));
  EXPECT_THAT(with("stepSize=\"0.1\"", "stepSize=\"0,1\""), Contains(HasSubstr("stepSize is \"0,1\"")));
  EXPECT_THAT(with("canSerializeFMUstate=\"true\"", "canSerializeFMUstate=\"yes\""),
              Contains(HasSubstr("canSerializeFMUstate is \"yes\"")));
  EXPECT_THAT(with("valueReference=\"0\"", "valueReference=\"-1\""), Contains(HasSubstr("valueReference is \"-1\"")));
  EXPECT_THAT(with("<Outputs>", "<Outputs><Unknown index=\"2\" dependencies=\"1\" dependenciesKind=\"maybe\"/>"),
              Contains(HasSubstr("dependenciesKind is \"maybe\"")));
  EXPECT_THAT(with("unit=\"m\"", "units=\"m\""), Contains(HasSubstr("no attribute units")));
  EXPECT_THAT(with("guid=", "generationDateAndTime=\"yesterday\" guid="),
              Contains(HasSubstr("generationDateAndTime is \"yesterday\"")));
  EXPECT_THAT(with("<LogCategories><Category name=\"logStatusError\"/></LogCategories>", "<LogCategories/>"),
              Contains(HasSubstr("contains no <Category>")));
  EXPECT_THAT(with("<Real start=\"1\" unit=\"m\"/>", ""), Contains(HasSubstr("\"u\" has 0 types")));
  EXPECT_THAT(with("<ModelStructure>", "<ModelStructure><Inputs/>"), Contains(HasSubstr("no such child")));
}

TEST(CheckSchema, DatesAreThoseOfXmlSchema) {
  const auto dated = [](const std::string& date) {
    return with("guid=", "generationDateAndTime=\"" + date + "\" guid=");
  };
  for (const char* good : {"2024-05-01T12:00:00Z", "-12024-05-01T12:00:00", "2024-05-01T12:00:00.25+02:00"})
    EXPECT_THAT(dated(good), IsEmpty()) << good;
  for (const char* bad :
       {"24-05-01T12:00:00Z", "2024-05-01 12:00:00", "2024-05-01T12:00:00.Z", "2024-05-01T12:00:00+2"})
    EXPECT_THAT(dated(bad), Contains(HasSubstr("generationDateAndTime is"))) << bad;
  EXPECT_THAT(dated(std::string(1'000'000, '1')), Contains(HasSubstr("generationDateAndTime is")))
      << "however long it is";
}

TEST(CheckSchema, OrderAndEncodingCount) {
  EXPECT_THAT(with("  <UnitDefinitions><Unit name=\"m\"><BaseUnit m=\"1\"/></Unit></UnitDefinitions>\n  "
                   "<LogCategories><Category name=\"logStatusError\"/></LogCategories>",
                   "<LogCategories><Category name=\"logStatusError\"/></LogCategories><UnitDefinitions><Unit "
                   "name=\"m\"/></UnitDefinitions>"),
              Contains(HasSubstr("must be before <LogCategories>")));
  EXPECT_THAT(with("encoding=\"UTF-8\"", "encoding=\"ISO-8859-1\""), Contains(HasSubstr("ISO-8859-1")));
  EXPECT_THAT(with("modelName=\"culprit\"", "modelName=\"b\xfcro\""), Contains(HasSubstr("not UTF-8")));
  EXPECT_THAT(with("modelName=\"culprit\"", "modelName=\"\x07\""), Contains(HasSubstr("control character 0x07")));
  EXPECT_THAT(with("<fmiModelDescription", "<!DOCTYPE x [<!ENTITY a \"b\">]><fmiModelDescription"),
              Contains(HasSubstr("DOCTYPE")));
  EXPECT_THAT(with("</ModelVariables>", ""), Contains(HasSubstr("not well-formed")));
}

}  // namespace
}  // namespace mebots::check
