// SPDX-License-Identifier: Apache-2.0
#include "pack_fmu.hpp"

#include "generate.hpp"
#include "mebots/error.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <ctime>
#include <tuple>

namespace mebots::modeldesc {
namespace {

using nlohmann::ordered_json;

constexpr const char* kNotSaid = "NOASSERTION";

std::string or_not_said(const std::string& text) {
  return text.empty() ? kNotSaid : text;
}

/// Returns the SPDX identifier of a package. It may contain only letters, digits, '.' and '-'.
std::string identifier(const std::string& name) {
  std::string text = "SPDXRef-Package-";
  for (const char c : name) text += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' ? c : '-';
  return text;
}

std::string time_text() {
  constexpr std::time_t kOfArchiveEntries = 315532800;  // 1980-01-01, the first date that zip can represent
  std::time_t time = kOfArchiveEntries;
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {  // NOLINT(concurrency-mt-unsafe): one thread
    char* end = nullptr;
    time = static_cast<std::time_t>(std::strtoll(epoch, &end, 10));
    if (end == epoch || *end != '\0' || time < 0)
      throw Error(ErrorCode::invalid_value,
                  fmt::format("SOURCE_DATE_EPOCH is '{}'; it must be a number of seconds since 1970", epoch));
  }
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time));
}

ordered_json package_of(const std::string& id, const std::string& name, const std::string& version,
                        const std::string& license) {
  ordered_json package{{"SPDXID", id}, {"name", name}};
  if (!version.empty()) package["versionInfo"] = version;
  package["downloadLocation"] = kNotSaid;
  package["filesAnalyzed"] = false;
  package["licenseConcluded"] = or_not_said(license);
  package["licenseDeclared"] = or_not_said(license);
  package["copyrightText"] = kNotSaid;
  return package;
}

ordered_json relationship(const std::string& from, const char* type, const std::string& to) {
  return {{"spdxElementId", from}, {"relationshipType", type}, {"relatedSpdxElement", to}};
}

const char* relation_of(const Part& part) {
  if (part.relation == "linked") return "STATIC_LINK";
  return part.relation == "bundled" ? "CONTAINS" : "DEPENDS_ON";
}

}  // namespace

std::string spdx_document(const Product& product, std::vector<Part> parts) {
  const auto key = [](const Part& part) { return std::tie(part.name, part.relation); };
  std::ranges::sort(parts, {}, key);
  // Avoids std::ranges::unique(), because clang 14, which builds the fuzzers, does not accept libstdc++'s subrange.
  const auto same = [&key](const Part& one, const Part& other) { return key(one) == key(other); };
  parts.erase(std::unique(parts.begin(), parts.end(), same), parts.end());

  const auto whole = identifier(product.name);
  ordered_json packages = ordered_json::array({package_of(whole, product.name, product.version, product.license)});
  ordered_json relationships = ordered_json::array({relationship("SPDXRef-DOCUMENT", "DESCRIBES", whole)});
  for (const auto& part : parts) {
    const auto id = identifier(part.name);
    const bool is_known =
        std::ranges::any_of(packages, [&](const ordered_json& other) { return other["SPDXID"] == id; });
    if (!is_known) {
      auto package = package_of(id, part.name, part.version, part.license);
      if (!part.locator.empty()) {
        package["externalRefs"] = ordered_json::array({{{"referenceCategory", "PACKAGE-MANAGER"},
                                                        {"referenceType", "purl"},
                                                        {"referenceLocator", part.locator}}});
      }
      packages.push_back(std::move(package));
    }
    relationships.push_back(relationship(whole, relation_of(part), id));
  }

  const auto name = product.version.empty() ? product.name : fmt::format("{}-{}", product.name, product.version);
  const auto hash = sha256_hex(packages.dump() + relationships.dump());
  const ordered_json document{
      {"spdxVersion", "SPDX-2.3"},
      {"dataLicense", "CC0-1.0"},
      {"SPDXID", "SPDXRef-DOCUMENT"},
      {"name", name},
      {"documentNamespace", fmt::format("https://spdx.org/spdxdocs/{}-{}", name, hash)},
      {"creationInfo", {{"created", time_text()}, {"creators", {"Tool: mebots-modeldesc-" MEBOTS_VERSION}}}},
      {"packages", packages},
      {"relationships", relationships}};
  return document.dump(2) + "\n";
}

}  // namespace mebots::modeldesc
