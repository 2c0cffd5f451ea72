// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zip.h>

#include <fmt/format.h>

#include <fstream>
#include <iterator>

namespace mebots::check {

namespace fs = std::filesystem;

std::string culprit_description(const std::string& crime) {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="culprit" guid="{{culprit:{}}}" variableNamingConvention="structured">
  <CoSimulation modelIdentifier="culprit" canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
  <UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions>
  <LogCategories><Category name="logStatusError"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="2" stepSize="0.1"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="1" unit="m"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output" initial="exact"><Real start="0" unit="m" max="100"/></ScalarVariable>
    <ScalarVariable name="gain" valueReference="2" causality="parameter" variability="fixed"><Real start="2"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2" dependencies=""/></Outputs>
  </ModelStructure>
</fmiModelDescription>
)",
                     crime);
}

fs::path Workshop::archive(const std::vector<std::pair<std::string, std::string>>& entries) {
  const auto file = folder_.path() / fmt::format("{}.fmu", ++made_);
  int code = 0;
  zip_t* zip = zip_open(file.c_str(), ZIP_CREATE, &code);
  for (const auto& [name, content] : entries) {
    zip_source_t* source = zip_source_buffer(zip, content.data(), content.size(), 0);
    // A name that starts with "link:" becomes a symbolic link.
    const bool link = name.starts_with("link:");
    const auto index = zip_file_add(zip, link ? name.c_str() + 5 : name.c_str(), source, ZIP_FL_ENC_UTF_8);
    EXPECT_GE(index, 0) << name;
    const mode_t kind = link ? S_IFLNK : S_IFREG;
    zip_file_set_external_attributes(zip, static_cast<zip_uint64_t>(index), 0, ZIP_OPSYS_UNIX, (kind | 0755U) << 16);
  }
  EXPECT_EQ(zip_close(zip), 0);
  return file;
}

fs::path Workshop::culprit(const std::string& crime, std::vector<std::pair<std::string, std::string>> more) {
  return culprit_with(culprit_description(crime), std::move(more));
}

fs::path Workshop::culprit_with(const std::string& description, std::vector<std::pair<std::string, std::string>> more) {
  std::ifstream stream(CULPRIT_LIBRARY, std::ios::binary);
  const std::string library{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  more.insert(more.begin(), {{"modelDescription.xml", description}, {"binaries/linux64/culprit.so", library}});
  return archive(more);
}

fs::path Workshop::described(const std::string& description) {
  return archive({{"modelDescription.xml", description}, {"binaries/linux64/culprit.so", "x"}});
}

std::vector<std::string> findings(const Report& report) {
  std::vector<std::string> lines;
  for (const auto& check : report.checks)
    for (const auto& finding : check.findings)
      lines.push_back(fmt::format("{}: {}", to_string(finding.severity), finding.text));
  return lines;
}

std::vector<std::string> findings(const fs::path& fmu, bool run, double deadline_s, Level level) {
  Options options;
  options.level = level;
  options.run = run;
  options.deadline_s = deadline_s;
  return findings(check_fmu(fmu, options));
}

}  // namespace mebots::check
