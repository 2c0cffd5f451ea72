// SPDX-License-Identifier: Apache-2.0
#include "schema_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <pugixml.hpp>
#include <span>
#include <string>
#include <vector>

namespace mebots::check {
namespace {

enum class Form { text, number, whole, count, flag, date, naming, causality, variability, initial, kinds };

struct Attribute {
  const char* name;
  Form form = Form::text;
  bool required = false;
};

struct Element;

struct Child {
  const char* name;
  const Element* element;
  std::size_t least = 0;
  std::size_t most = SIZE_MAX;
};

/// What one element may hold. Children stand in the order given; `alternatives` take exactly one of them instead of
/// all.
struct Element {
  std::vector<Attribute> attributes;
  std::vector<Child> children;
  bool alternatives = false;  // exactly one of `children` that come before Annotations
  bool anything = false;      // a vendor's own contents
};

// FMI 2.0.4, sections 2.2 and 4.3.1, written from the text of the standard.
const Element kVendor{.attributes = {}, .children = {}, .anything = true};
const Element kTool{.attributes = {{"name", Form::text, true}}, .children = {}, .anything = true};
const Element kAnnotations{.attributes = {}, .children = {{"Tool", &kTool, 1}}};
const Element kFile{.attributes = {{"name", Form::text, true}}, .children = {}};
const Element kSourceFiles{.attributes = {}, .children = {{"File", &kFile, 1}}};
const Element kModelExchange{.attributes = {{"modelIdentifier", Form::text, true},
                                            {"needsExecutionTool", Form::flag},
                                            {"completedIntegratorStepNotNeeded", Form::flag},
                                            {"canBeInstantiatedOnlyOncePerProcess", Form::flag},
                                            {"canNotUseMemoryManagementFunctions", Form::flag},
                                            {"canGetAndSetFMUstate", Form::flag},
                                            {"canSerializeFMUstate", Form::flag},
                                            {"providesDirectionalDerivative", Form::flag}},
                             .children = {{"SourceFiles", &kSourceFiles, 0, 1}}};
const Element kCoSimulation{.attributes = {{"modelIdentifier", Form::text, true},
                                           {"needsExecutionTool", Form::flag},
                                           {"canHandleVariableCommunicationStepSize", Form::flag},
                                           {"canInterpolateInputs", Form::flag},
                                           {"maxOutputDerivativeOrder", Form::count},
                                           {"canRunAsynchronuously", Form::flag},
                                           {"canBeInstantiatedOnlyOncePerProcess", Form::flag},
                                           {"canNotUseMemoryManagementFunctions", Form::flag},
                                           {"canGetAndSetFMUstate", Form::flag},
                                           {"canSerializeFMUstate", Form::flag},
                                           {"providesDirectionalDerivative", Form::flag}},
                            .children = {{"SourceFiles", &kSourceFiles, 0, 1}}};
const Element kBaseUnit{.attributes = {{"kg", Form::whole},
                                       {"m", Form::whole},
                                       {"s", Form::whole},
                                       {"A", Form::whole},
                                       {"K", Form::whole},
                                       {"mol", Form::whole},
                                       {"cd", Form::whole},
                                       {"rad", Form::whole},
                                       {"factor", Form::number},
                                       {"offset", Form::number}},
                        .children = {}};
const Element kDisplayUnit{
    .attributes = {{"name", Form::text, true}, {"factor", Form::number}, {"offset", Form::number}}, .children = {}};
const Element kUnit{.attributes = {{"name", Form::text, true}},
                    .children = {{"BaseUnit", &kBaseUnit, 0, 1}, {"DisplayUnit", &kDisplayUnit}}};
const Element kUnits{.attributes = {}, .children = {{"Unit", &kUnit, 1}}};

const Element kItem{.attributes = {{"name", Form::text, true}, {"value", Form::whole, true}, {"description"}},
                    .children = {}};
const Element kRealType{.attributes = {{"quantity"},
                                       {"unit"},
                                       {"displayUnit"},
                                       {"relativeQuantity", Form::flag},
                                       {"min", Form::number},
                                       {"max", Form::number},
                                       {"nominal", Form::number},
                                       {"unbounded", Form::flag}},
                        .children = {}};
const Element kIntegerType{.attributes = {{"quantity"}, {"min", Form::whole}, {"max", Form::whole}}, .children = {}};
const Element kNothing{.attributes = {}, .children = {}};
const Element kEnumerationType{.attributes = {{"quantity"}}, .children = {{"Item", &kItem, 1}}};
const Element kSimpleType{.attributes = {{"name", Form::text, true}, {"description"}},
                          .children = {{"Real", &kRealType, 0, 1},
                                       {"Integer", &kIntegerType, 0, 1},
                                       {"Boolean", &kNothing, 0, 1},
                                       {"String", &kNothing, 0, 1},
                                       {"Enumeration", &kEnumerationType, 0, 1}},
                          .alternatives = true};
const Element kTypes{.attributes = {}, .children = {{"SimpleType", &kSimpleType, 1}}};

const Element kCategory{.attributes = {{"name", Form::text, true}, {"description"}}, .children = {}};
const Element kCategories{.attributes = {}, .children = {{"Category", &kCategory, 1}}};
const Element kExperiment{.attributes = {{"startTime", Form::number},
                                         {"stopTime", Form::number},
                                         {"tolerance", Form::number},
                                         {"stepSize", Form::number}},
                          .children = {}};

const Element kReal{.attributes = {{"declaredType"},
                                   {"quantity"},
                                   {"unit"},
                                   {"displayUnit"},
                                   {"relativeQuantity", Form::flag},
                                   {"min", Form::number},
                                   {"max", Form::number},
                                   {"nominal", Form::number},
                                   {"unbounded", Form::flag},
                                   {"start", Form::number},
                                   {"derivative", Form::count},
                                   {"reinit", Form::flag}},
                    .children = {}};
const Element kInteger{
    .attributes = {{"declaredType"}, {"quantity"}, {"min", Form::whole}, {"max", Form::whole}, {"start", Form::whole}},
    .children = {}};
const Element kBoolean{.attributes = {{"declaredType"}, {"start", Form::flag}}, .children = {}};
const Element kString{.attributes = {{"declaredType"}, {"start"}}, .children = {}};
const Element kEnumeration{.attributes = {{"declaredType", Form::text, true},
                                          {"quantity"},
                                          {"min", Form::whole},
                                          {"max", Form::whole},
                                          {"start", Form::whole}},
                           .children = {}};
const Element kVariable{.attributes = {{"name", Form::text, true},
                                       {"valueReference", Form::count, true},
                                       {"description"},
                                       {"causality", Form::causality},
                                       {"variability", Form::variability},
                                       {"initial", Form::initial},
                                       {"canHandleMultipleSetPerTimeInstant", Form::flag}},
                        .children = {{"Real", &kReal, 0, 1},
                                     {"Integer", &kInteger, 0, 1},
                                     {"Boolean", &kBoolean, 0, 1},
                                     {"String", &kString, 0, 1},
                                     {"Enumeration", &kEnumeration, 0, 1},
                                     {"Annotations", &kAnnotations, 0, 1}},
                        .alternatives = true};
const Element kVariables{.attributes = {}, .children = {{"ScalarVariable", &kVariable, 1}}};
const Element kUnknown{
    .attributes = {{"index", Form::count, true}, {"dependencies"}, {"dependenciesKind", Form::kinds}}, .children = {}};
const Element kUnknowns{.attributes = {}, .children = {{"Unknown", &kUnknown, 1}}};
const Element kStructure{
    .attributes = {},
    .children = {
        {"Outputs", &kUnknowns, 0, 1}, {"Derivatives", &kUnknowns, 0, 1}, {"InitialUnknowns", &kUnknowns, 0, 1}}};
const Element kRoot{.attributes = {{"fmiVersion", Form::text, true},
                                   {"modelName", Form::text, true},
                                   {"guid", Form::text, true},
                                   {"description"},
                                   {"author"},
                                   {"version"},
                                   {"copyright"},
                                   {"license"},
                                   {"generationTool"},
                                   {"generationDateAndTime", Form::date},
                                   {"variableNamingConvention", Form::naming},
                                   {"numberOfEventIndicators", Form::count}},
                    .children = {{"ModelExchange", &kModelExchange, 0, 1},
                                 {"CoSimulation", &kCoSimulation, 0, 1},
                                 {"UnitDefinitions", &kUnits, 0, 1},
                                 {"TypeDefinitions", &kTypes, 0, 1},
                                 {"LogCategories", &kCategories, 0, 1},
                                 {"DefaultExperiment", &kExperiment, 0, 1},
                                 {"VendorAnnotations", &kAnnotations, 0, 1},
                                 {"ModelVariables", &kVariables, 1, 1},
                                 {"ModelStructure", &kStructure, 1, 1}}};

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1));
}

template <typename T>
bool is_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

bool is_one_of(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, text) != words.end();
}

constexpr std::string_view kKindWords[] = {"dependent", "constant", "fixed", "tunable", "discrete"};

/// Takes leading digits off the text and counts them.
std::size_t take_digits(std::string_view& text) {
  const auto end = std::min(text.find_first_not_of("0123456789"), text.size());
  text.remove_prefix(end);
  return end;
}

/// 2024-05-01T12:00:00, with an optional fraction and zone. By hand: std::regex recurses for every character.
bool is_date(std::string_view text) {
  const auto take = [&](std::string_view shape) {
    if (text.size() < shape.size()) return false;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const bool digit = text[i] >= '0' && text[i] <= '9';
      if (shape[i] == '0' ? !digit : text[i] != shape[i]) return false;
    }
    text.remove_prefix(shape.size());
    return true;
  };
  if (text.starts_with('-')) text.remove_prefix(1);
  if (take_digits(text) < 4 || !take("-00-00T00:00:00")) return false;
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    if (take_digits(text) == 0) return false;
  }
  return text.empty() || ((take("Z") || take("+00:00") || take("-00:00")) && text.empty());
}

bool has_form(const std::string& value, Form form) {
  switch (form) {
    case Form::text:
      return true;
    case Form::number:
      // XML Schema writes INF, and knows no "inf" or "nan" of other spellings.
      return is_one_of(value, {"INF", "-INF", "NaN"}) ||
             (is_number<double>(value) && value.find_first_of("iInN") == std::string::npos);
    case Form::whole:
      return is_number<std::int32_t>(value);
    case Form::count:
      return is_number<std::uint32_t>(value);
    case Form::flag:
      return is_one_of(value, {"true", "false", "0", "1"});
    case Form::date:
      return is_date(value);
    case Form::naming:
      return is_one_of(value, {"flat", "structured"});
    case Form::causality:
      return is_one_of(value, {"parameter", "calculatedParameter", "input", "output", "local", "independent"});
    case Form::variability:
      return is_one_of(value, {"constant", "fixed", "tunable", "discrete", "continuous"});
    case Form::initial:
      return is_one_of(value, {"exact", "approx", "calculated"});
    case Form::kinds: {
      std::size_t at = 0;
      while ((at = value.find_first_not_of(" \t\r\n", at)) != std::string::npos) {
        const auto end = std::min(value.find_first_of(" \t\r\n", at), value.size());
        if (std::ranges::find(kKindWords, value.substr(at, end - at)) == std::end(kKindWords)) return false;
        at = end;
      }
      return true;
    }
  }
  return true;
}

std::string expected(Form form) {
  switch (form) {
    case Form::number:
      return "a number such as 0.5, 1e-3 or INF";
    case Form::whole:
      return "a whole number of 32 bits";
    case Form::count:
      return "a whole number from 0 to 4294967295";
    case Form::flag:
      return "true or false";
    case Form::date:
      return "a date and time such as 2024-05-01T12:00:00Z";
    case Form::naming:
      return "flat or structured";
    case Form::causality:
      return "parameter, calculatedParameter, input, output, local or independent";
    case Form::variability:
      return "constant, fixed, tunable, discrete or continuous";
    case Form::initial:
      return "exact, approx or calculated";
    case Form::kinds:
      return fmt::format("a list of {}", fmt::join(kKindWords, ", "));
    case Form::text:
      break;
  }
  return "a text";
}

class SchemaCheck {
 public:
  SchemaCheck(std::string_view text, Findings findings) : text_(text), findings_(findings) {}

  void run() {
    check_bytes();
    pugi::xml_document document;
    const auto parsed = document.load_buffer(text_.data(), text_.size(),
                                             pugi::parse_default | pugi::parse_doctype | pugi::parse_declaration);
    if (!parsed) {
      findings_.error(fmt::format("line {}: not well-formed XML: {}", line(parsed.offset), parsed.description()),
                      "write the file with an XML library");
      return;
    }
    for (const auto node : document.children()) {
      if (node.type() == pugi::node_doctype)
        findings_.warning(
            fmt::format("line {}: there is a DOCTYPE, which FMI 2.0 does not use", line(node.offset_debug())),
            "remove it: careful tools refuse such files");
      const std::string encoding = node.type() == pugi::node_declaration ? node.attribute("encoding").value() : "";
      if (!encoding.empty() && encoding != "UTF-8" && encoding != "utf-8")
        findings_.error(fmt::format("the file says that its encoding is {}; FMI 2.0 demands UTF-8", encoding),
                        "write it in UTF-8");
    }
    const auto root = document.document_element();
    if (std::string_view(root.name()) != "fmiModelDescription") {
      findings_.error(fmt::format("the root element is <{}>, not <fmiModelDescription>", root.name()),
                      "is this the description of an FMU?");
      return;
    }
    check_element(root, kRoot);
  }

 private:
  void check_bytes() {
    // Outside of ASCII the file must be UTF-8; control characters are not allowed in XML 1.0.
    for (std::size_t i = 0; i < text_.size();) {
      const auto byte = static_cast<unsigned char>(text_[i]);
      if (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') {
        findings_.error(fmt::format("line {}: control character 0x{:02x}", line(static_cast<std::ptrdiff_t>(i)), byte),
                        "remove it");
        return;
      }
      const std::size_t length = byte < 0x80         ? 1
                                 : (byte >> 5) == 6  ? 2
                                 : (byte >> 4) == 14 ? 3
                                 : (byte >> 3) == 30 ? 4
                                                     : 0;
      bool good = length != 0 && i + length <= text_.size();
      for (std::size_t k = 1; good && k < length; ++k) good = (static_cast<unsigned char>(text_[i + k]) >> 6) == 2;
      if (!good) {
        findings_.error(fmt::format("line {}: byte 0x{:02x} is no UTF-8", line(static_cast<std::ptrdiff_t>(i)), byte),
                        "write the file in UTF-8");
        return;
      }
      i += length;
    }
  }

  void check_element(pugi::xml_node node, const Element& rule) {
    check_attributes(node, rule);
    if (rule.anything) return;
    check_children(node, rule);
  }

  void check_attributes(pugi::xml_node node, const Element& rule) {
    for (const auto attribute : node.attributes()) {
      const std::string_view name = attribute.name();
      if (name.starts_with("xmlns") || name.starts_with("xsi:")) continue;
      const auto found =
          std::ranges::find(rule.attributes, name, [](const Attribute& a) { return std::string_view(a.name); });
      if (found == rule.attributes.end()) {
        if (!rule.anything)
          error(
              node, fmt::format("there is no attribute {} in FMI 2.0", name),
              rule.attributes.empty() ? "remove it" : fmt::format("remove it; known here: {}", names(rule.attributes)));
        continue;
      }
      const auto value = found->form == Form::text ? std::string(attribute.value()) : trimmed(attribute.value());
      if (!has_form(value, found->form))
        error(node, fmt::format("{} is \"{}\"", name, value), fmt::format("write {}", expected(found->form)));
    }
    for (const auto& attribute : rule.attributes)
      if (attribute.required && !node.attribute(attribute.name))
        error(node, fmt::format("the attribute {} is missing", attribute.name), "add it");
  }

  void check_children(pugi::xml_node node, const Element& rule) {
    std::map<std::string_view, std::size_t> counts;
    std::size_t last = 0;
    std::size_t chosen = 0;
    for (const auto child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      const std::string_view name = child.name();
      const auto found =
          std::ranges::find(rule.children, name, [](const Child& c) { return std::string_view(c.name); });
      if (found == rule.children.end()) {
        error(child, fmt::format("<{}> has no such child in FMI 2.0", node.name()),
              rule.children.empty() ? "remove it" : fmt::format("remove it; known here: {}", names(rule.children)));
        continue;
      }
      const auto position = static_cast<std::size_t>(found - rule.children.begin());
      // FMI allows ModelExchange and CoSimulation in either order.
      const bool swapped = name == "ModelExchange" && last == 1;
      if (position < last && !swapped)
        error(child, fmt::format("it stands after <{}>", rule.children[last].name),
              fmt::format("the order is: {}", names(rule.children)));
      last = std::max(last, position);
      if (++counts[name] == found->most + 1)
        error(child, fmt::format("it is there twice in <{}>", node.name()), "keep one");
      if (rule.alternatives && name != "Annotations") ++chosen;
      check_element(child, *found->element);
    }
    for (const auto& child : rule.children)
      if (counts[child.name] < child.least)
        error(node, fmt::format("it holds no <{}>", child.name), fmt::format("add one, or remove <{}>", node.name()));
    if (rule.alternatives && chosen != 1)
      error(node, fmt::format("\"{}\" has {} types", node.attribute("name").value(), chosen),
            "give it one of <Real>, <Integer>, <Boolean>, <String>, <Enumeration>");
  }

  void error(pugi::xml_node node, std::string_view what, std::string way_out) {
    constexpr std::size_t kMost = 50;  // a description that is wrong throughout says the same a million times
    if (++errors_ > kMost) return;
    findings_.error(fmt::format("line {}, <{}>: {}", line(node.offset_debug()), node.name(), what), std::move(way_out));
  }

  template <typename T>
  static std::string names(const std::vector<T>& list) {
    std::string text;
    for (const auto& item : list) text += (text.empty() ? "" : ", ") + std::string(item.name);
    return text;
  }

  std::ptrdiff_t line(std::ptrdiff_t offset) const {
    const auto end = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
    return 1 + std::count(text_.begin(), text_.begin() + end, '\n');
  }

  std::string_view text_;
  Findings findings_;
  std::size_t errors_ = 0;
};

}  // namespace

void check_schema(std::string_view text, Findings findings) {
  SchemaCheck(text, findings).run();
}

}  // namespace mebots::check
