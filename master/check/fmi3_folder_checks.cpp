// SPDX-License-Identifier: Apache-2.0
// Checks the files of an unpacked FMI 3.0 FMU, except modelDescription.xml.
#include "checks.hpp"
#include "fmi3_description.hpp"

#include "fmi/library_state.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "mebots/modeldesc/xml.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace mebots::check {
namespace {

namespace fs = std::filesystem;

/// Returns the platform of a folder, or null. Ignores the ABI in the name <architecture>-<system>{-<ABI>}.
const modeldesc::Platform* platform_named(std::string_view name) {
  const auto system = name.find('-') + 1;
  const auto platforms = modeldesc::platforms();
  const auto found =
      std::ranges::find(platforms, name.substr(0, name.find('-', system)), &modeldesc::Platform::fmi3_folder);
  return found == platforms.end() ? nullptr : &*found;
}

void check_terminal(pugi::xml_node terminal, const std::set<std::string>& variables, Findings findings) {
  const std::string_view rule = terminal.attribute("matchingRule").value();
  const bool by_name = rule == "plug" || rule == "bus";
  std::set<std::string> members;
  for (const auto member : terminal.children("TerminalMemberVariable")) {
    const std::string variable = member.attribute("variableName").value();
    const std::string name = member.attribute("memberName").value();
    if (!variables.contains(variable))
      findings.error(fmt::format("terminal {}: {} is not a variable", terminal.attribute("name").value(), variable),
                     "use the name of a variable in modelDescription.xml");
    if (by_name && (name.empty() || !members.insert(name).second))
      findings.error(fmt::format("terminal {}: {}", terminal.attribute("name").value(),
                                 name.empty() ? fmt::format("{} has no memberName", variable)
                                              : fmt::format("two members are named {}", name)),
                     fmt::format("the matching rule {} needs different names", rule));
  }
  for (const auto inner : terminal.children("Terminal")) check_terminal(inner, variables, findings);
}

/// Finds an attribute by its name without prefix.
pugi::xml_attribute local_attribute(pugi::xml_node node, std::string_view name) {
  for (const auto attribute : node.attributes()) {
    std::string_view own = attribute.name();
    own.remove_prefix(own.find(':') == std::string_view::npos ? 0 : own.find(':') + 1);
    if (own == name) return attribute;
  }
  return {};
}

void check_manifest(const fs::path& file, const std::string& shown, Findings findings) {
  pugi::xml_document document;
  try {
    modeldesc::parse_xml(document, modeldesc::xml_as_utf8(text_of(file), shown), shown);
  } catch (const Error& error) {
    findings.error(error.what(), "write the manifest as described in FMI 3.0, section 2.6");
    return;
  }
  const auto root = document.document_element();
  for (const char* const name : {"fmi-ls-name", "fmi-ls-version"})
    if (*local_attribute(root, name).value() == '\0')
      findings.error(fmt::format("{}: the attribute {} is missing", shown, name), "add it");
  if (!local_attribute(root, "fmi-ls-description"))
    findings.at(Level::pedantic)
        .warning(fmt::format("{}: the attribute fmi-ls-description is missing", shown),
                 "add a description for readers");
}

bool is_reversed_domain(std::string_view name) {
  const auto is_label = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.'; };
  return name.find('.') != std::string_view::npos && name.front() != '.' && name.back() != '.' &&
         std::ranges::all_of(name, is_label);
}

/// The names of functions without the prefix "fmi3", separated by spaces. Every FMU must export those in kCommon; each
/// other constant names those of one interface type.
constexpr std::string_view kCommon =
    "GetVersion SetDebugLogging FreeInstance EnterInitializationMode ExitInitializationMode EnterEventMode Terminate "
    "Reset GetFloat32 GetFloat64 GetInt8 GetUInt8 GetInt16 GetUInt16 GetInt32 GetUInt32 GetInt64 GetUInt64 GetBoolean "
    "GetString GetBinary GetClock SetFloat32 SetFloat64 SetInt8 SetUInt8 SetInt16 SetUInt16 SetInt32 SetUInt32 "
    "SetInt64 "
    "SetUInt64 SetBoolean SetString SetBinary SetClock GetNumberOfVariableDependencies GetVariableDependencies "
    "GetFMUState SetFMUState FreeFMUState SerializedFMUStateSize SerializeFMUState DeserializeFMUState "
    "GetDirectionalDerivative GetAdjointDerivative EnterConfigurationMode ExitConfigurationMode GetIntervalDecimal "
    "GetIntervalFraction GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction SetShiftDecimal "
    "SetShiftFraction EvaluateDiscreteStates UpdateDiscreteStates";
constexpr std::string_view kModelExchange =
    "InstantiateModelExchange EnterContinuousTimeMode CompletedIntegratorStep SetTime SetContinuousStates "
    "GetContinuousStateDerivatives GetEventIndicators GetContinuousStates GetNominalsOfContinuousStates "
    "GetNumberOfEventIndicators GetNumberOfContinuousStates";
constexpr std::string_view kCoSimulation = "InstantiateCoSimulation EnterStepMode GetOutputDerivatives DoStep";
constexpr std::string_view kScheduledExecution = "InstantiateScheduledExecution ActivateModelPartition";

std::vector<std::string> wanted_functions(const Fmi3Description& description) {
  std::vector<std::string> names = words_of(kCommon);
  for (const auto node : description.interfaces()) {
    const std::string_view kind = node.name();
    for (auto& name : words_of(kind == "ModelExchange"  ? kModelExchange
                               : kind == "CoSimulation" ? kCoSimulation
                                                        : kScheduledExecution))
      names.push_back(std::move(name));
  }
  for (auto& name : names) name.insert(0, "fmi3");
  return names;
}

}  // namespace

fs::path fmi3_library_path(const Fmi3Description& description, const fs::path& folder) {
  const auto interfaces = description.interfaces();
  const std::string identifier =
      interfaces.empty() ? "" : description.interfaces().front().attribute("modelIdentifier").value();
  return modeldesc::binaries_folder(folder, true, identifier + ".so") / (identifier + ".so");
}

void check_fmi3_terminals(const Fmi3Description& description, const fs::path& folder, Findings findings) {
  const auto place = folder / "terminalsAndIcons";
  const auto file = place / "terminalsAndIcons.xml";
  if (!is_file(file)) return;
  const std::string text = text_of(file);
  check_terminals_schema(text, findings);
  if (findings.any()) return;
  pugi::xml_document document;
  modeldesc::parse_xml(document, text, "terminalsAndIcons.xml");
  std::set<std::string> variables;
  for (const Fmi3Declared& variable : description.variables()) {
    variables.insert(variable.name);
    for (const auto alias : variable.node.children("Alias")) variables.insert(alias.attribute("name").value());
  }
  std::set<std::string> names;
  for (const auto terminal : document.document_element().child("Terminals").children("Terminal")) {
    if (!names.insert(terminal.attribute("name").value()).second)
      findings.error(fmt::format("the terminal {} occurs twice", terminal.attribute("name").value()), "rename one");
    check_terminal(terminal, variables, findings);
  }
  if (document.document_element().child("GraphicalRepresentation").child("Icon") && !is_file(place / "icon.png"))
    findings.error("terminalsAndIcons.xml announces an icon, but terminalsAndIcons/icon.png is missing",
                   "add the picture, or remove <Icon>");
}

void check_extra(const fs::path& folder, Findings findings) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder / "extra", ignored)) {
    const auto name = entry.path().filename().string();
    if (!is_reversed_domain(name))
      findings.warning(fmt::format("extra/{} is not named after a reversed domain", name),
                       "name it like org.example.subject, so that no other tool uses the name");
    const auto manifest = entry.path() / "fmi-ls-manifest.xml";
    if (is_file(manifest)) check_manifest(manifest, fmt::format("extra/{}/fmi-ls-manifest.xml", name), findings);
  }
}

void check_fmi3_platforms(const Fmi3Description& description, const fs::path& folder, Findings findings) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder / "binaries", ignored)) {
    const auto name = entry.path().filename().string();
    const auto* const platform = platform_named(name);
    if (platform == nullptr) {
      findings.warning(fmt::format("binaries/{} is not a platform that FMI 3.0 names", name),
                       "FMI 3.0 names platforms <architecture>-<system>: x86_64-linux, aarch64-darwin, x86_64-windows");
      continue;
    }
    for (const auto node : description.interfaces()) {
      const auto library = fmt::format("{}{}", node.attribute("modelIdentifier").value(), platform->suffix);
      if (is_there(entry.path() / library))
        check_machine(entry.path() / library, *platform, findings);
      else
        findings.error(fmt::format("binaries/{} contains no {}, the library of <{}>", name, library, node.name()),
                       "name the library after modelIdentifier");
    }
  }
  check_own_binary(fmi3_library_path(description, folder), findings);
}

void check_fmi3_symbols(const Fmi3Description& description, const fs::path& library, Findings findings) {
  const auto exports = modeldesc::read_elf_library(library).exports();
  const std::set<std::string> names(exports.begin(), exports.end());
  std::vector<std::string> missing;
  for (const auto& name : wanted_functions(description))
    if (!names.contains(name)) missing.push_back(name);
  if (!missing.empty())
    findings.error(
        fmt::format("{} lacks {}", library.filename().string(), fmt::join(missing, ", ")),
        "export them with default visibility and C linkage; a function that the FMU does not offer returns fmi3Error");
  const auto others = std::ranges::count_if(names, [](const std::string& name) {
    return !name.starts_with("fmi3") && name != master::kKeepsNoState && !name.starts_with('_');
  });
  if (others != 0)
    findings.at(Level::pedantic)
        .warning(fmt::format("{} exports {} names that do not begin with fmi3: they can collide with another FMU's",
                             library.filename().string(), others),
                 "hide them: -fvisibility=hidden, or a linker version script that keeps fmi3*");
}

}  // namespace mebots::check
