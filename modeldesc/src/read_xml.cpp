// SPDX-License-Identifier: Apache-2.0
#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <malloc.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <set>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace mebots::modeldesc {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const auto first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// The whole text as a number, or nothing. XML Schema writes infinities as INF, and allows a plus sign.
template <typename T>
std::optional<T> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// A parsed document, and the lines of its elements for messages. It needs the text during the parse only.
class Document {
 public:
  Document(const std::string& text, std::string_view source) : source_(source) {
    parse_xml(xml_, text, source);
    for (auto at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1)) {
      line_ends_.push_back(static_cast<std::ptrdiff_t>(at));
    }
  }

  pugi::xml_node root() const { return xml_.document_element(); }

  /// "line 7, <Real>: what"
  std::string located(pugi::xml_node node, std::string_view what) const {
    const auto line = std::ranges::lower_bound(line_ends_, node.offset_debug()) - line_ends_.begin() + 1;
    return fmt::format("line {}, <{}>: {}", line, node.name(), what);
  }
  [[noreturn]] void fail(pugi::xml_node node, std::string_view what) const {
    throw Error(ErrorCode::syntax_error, fmt::format("{}, {}", source_, located(node, what)));
  }

 private:
  std::string source_;
  pugi::xml_document xml_;
  std::vector<std::ptrdiff_t> line_ends_;
};

/// One element with typed, checked access to its attributes.
class Element {
 public:
  Element(const Document& document, pugi::xml_node node) : document_(&document), node_(node) {}

  explicit operator bool() const { return static_cast<bool>(node_); }
  std::string_view name() const { return node_.name(); }
  Element child(const char* name) const { return {*document_, node_.child(name)}; }
  bool has(const char* name) const { return static_cast<bool>(node_.attribute(name)); }
  std::string text(const char* name) const { return node_.attribute(name).value(); }  // empty when missing

  std::string required_text(const char* name) const {
    if (!has(name)) fail(fmt::format("the attribute {} is missing", name));
    return text(name);
  }

  bool flag(const char* name, bool fallback) const {
    if (!has(name)) return fallback;
    return *parse_flag(name);
  }

  template <typename T>
  std::optional<T> number(const char* name, std::string_view expected) const {
    if (!has(name)) return std::nullopt;
    const auto value = parse_number<T>(text(name));
    if (!value) fail(fmt::format("the attribute {} is \"{}\", but {} is expected", name, text(name), expected));
    return value;
  }
  std::optional<double> real(const char* name) const { return number<double>(name, "a number"); }

  /// The value that belongs to the attribute's word.
  template <typename T>
  std::optional<T> word(const char* name, std::span<const std::string_view> words) const {
    if (!has(name)) return std::nullopt;
    const auto found = std::ranges::find(words, text(name));
    if (found == words.end())
      fail(fmt::format("the attribute {} is \"{}\"; FMI 2.0 knows {}", name, text(name), fmt::join(words, ", ")));
    return static_cast<T>(found - words.begin());
  }

  std::optional<bool> parse_flag(const char* name) const {
    const std::string value(trimmed(text(name)));
    if (value == "true" || value == "1") return true;
    if (value == "false" || value == "0") return false;
    fail(fmt::format("the attribute {} is \"{}\", but true or false is expected", name, value));
  }

  template <typename Action>
  void each_child(Action action) const {
    for (const pugi::xml_node node : node_.children())
      if (node.type() == pugi::node_element) action(Element(*document_, node));
  }
  template <typename Action>
  void each_child(const char* name, Action action) const {
    for (const pugi::xml_node node : node_.children(name)) action(Element(*document_, node));
  }
  std::size_t count_children(const char* name) const {
    const auto children = node_.children(name);
    return static_cast<std::size_t>(std::distance(children.begin(), children.end()));
  }
  /// As each_child(), and removes each child afterwards, so that its memory is free again.
  template <typename Action>
  void consume_children(const char* name, Action action) {
    for (auto node = node_.child(name); node;) {
      action(Element(*document_, node));
      node_.remove_child(std::exchange(node, node.next_sibling(name)));
    }
  }

  std::string located(std::string_view what) const { return document_->located(node_, what); }
  [[noreturn]] void fail(std::string_view what) const { document_->fail(node_, what); }

 private:
  const Document* document_;
  pugi::xml_node node_;
};

/// The child that says the type, <Real> and so on.
std::pair<Type, Element> type_child(const Element& parent) {
  std::optional<std::pair<Type, Element>> found;
  parent.each_child([&](const Element& child) {
    const auto* const word = std::ranges::find(fmi2::kTypeWords, child.name());
    if (word == std::end(fmi2::kTypeWords)) return;
    if (found) child.fail(fmt::format("\"{}\" has two types", parent.text("name")));
    found = {static_cast<Type>(word - std::begin(fmi2::kTypeWords)), child};
  });
  if (!found)
    parent.fail(
        fmt::format("\"{}\" has no type: one of <Real>, <Integer>, <Boolean>, <String>, <Enumeration> is expected",
                    parent.text("name")));
  return *found;
}

/// FMI 2.0.4, table on page 51.
std::optional<Initial> default_initial(Causality causality, Variability variability) {
  switch (causality) {
    case Causality::parameter:
      return Initial::exact;
    case Causality::input:
    case Causality::independent:
      return std::nullopt;
    case Causality::calculated_parameter:
    case Causality::output:
    case Causality::local:
      break;
  }
  return variability == Variability::constant ? Initial::exact : Initial::calculated;
}

/// Variables that are read before the memory of their elements goes back to the system. Elements and variables together
/// would double the peak of a description with a million variables.
constexpr std::size_t kVariablesPerTrim = 1 << 16;

void release_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

class XmlReader {
 public:
  explicit XmlReader(const Document& document) : root_(document, document.root()) {}

  ModelDescription read() {
    read_root();
    read_implementations();
    root_.child("UnitDefinitions").each_child("Unit", [&](const Element& e) { read_unit(e); });
    root_.child("TypeDefinitions").each_child("SimpleType", [&](const Element& e) { read_type(e); });
    root_.child("LogCategories").each_child("Category", [&](const Element& e) {
      result_.log_categories.push_back({e.required_text("name"), e.text("description")});
    });
    if (const Element experiment = root_.child("DefaultExperiment"))
      result_.default_experiment = {experiment.real("startTime"), experiment.real("stopTime"),
                                    experiment.real("tolerance"), experiment.real("stepSize")};
    Element variables = root_.child("ModelVariables");
    if (!variables) root_.fail("the element <ModelVariables> is missing");
    result_.variables.reserve(variables.count_children("ScalarVariable"));
    names_.reserve(result_.variables.capacity());
    variables.consume_children("ScalarVariable", [&](const Element& e) {
      read_variable(e);
      if (result_.variables.size() % kVariablesPerTrim == 0) release_free_memory();
    });
    check_derivatives(variables);
    const Element structure = root_.child("ModelStructure");
    if (!structure) root_.fail("the element <ModelStructure> is missing");
    result_.outputs = read_unknowns(structure.child("Outputs"));
    result_.derivatives = read_unknowns(structure.child("Derivatives"));
    result_.initial_unknowns = read_unknowns(structure.child("InitialUnknowns"));
    result_.index_names();
    return std::move(result_);
  }

 private:
  void read_root() {
    if (root_.name() != "fmiModelDescription") root_.fail("the root element must be <fmiModelDescription>");
    result_.fmi_version = root_.required_text("fmiVersion");
    if (result_.fmi_version != "2.0")
      root_.fail(fmt::format("the FMU is of FMI version {}; only 2.0 can be used", result_.fmi_version));
    result_.model_name = root_.required_text("modelName");
    result_.guid = root_.required_text("guid");
    result_.text = root_.text("description");
    result_.author = root_.text("author");
    result_.version = root_.text("version");
    result_.copyright = root_.text("copyright");
    result_.license = root_.text("license");
    result_.generation_tool = root_.text("generationTool");
    result_.generation_date_and_time = root_.text("generationDateAndTime");
    const std::string naming = root_.text("variableNamingConvention");
    if (!naming.empty() && naming != "flat" && naming != "structured")
      root_.fail(fmt::format("variableNamingConvention is \"{}\", but flat or structured is expected", naming));
    result_.structured_names = naming == "structured";
    result_.number_of_event_indicators = count(root_, "numberOfEventIndicators");
  }

  static std::uint32_t count(const Element& element, const char* name) {
    return element.number<std::uint32_t>(name, "a count").value_or(0);
  }

  void read_implementations() {
    const Element model_exchange = root_.child("ModelExchange");
    const Element co_simulation = root_.child("CoSimulation");
    if (!co_simulation && !model_exchange) root_.fail("neither <CoSimulation> nor <ModelExchange> is there");
    if (model_exchange) read_model_exchange(model_exchange);
    if (co_simulation) read_co_simulation(co_simulation);
  }

  void read_model_exchange(const Element& element) {
    ModelExchange& flags = result_.model_exchange.emplace();
    read_implementation(element, flags);
    flags.completed_integrator_step_not_needed = element.flag("completedIntegratorStepNotNeeded", false);
  }

  void read_co_simulation(const Element& element) {
    CoSimulation& flags = result_.co_simulation.emplace();
    read_implementation(element, flags);
    flags.can_handle_variable_communication_step_size = element.flag("canHandleVariableCommunicationStepSize", false);
    flags.can_interpolate_inputs = element.flag("canInterpolateInputs", false);
    flags.max_output_derivative_order = count(element, "maxOutputDerivativeOrder");
    flags.can_run_asynchronuously = element.flag("canRunAsynchronuously", false);
  }

  static void read_implementation(const Element& element, Implementation& flags) {
    flags.model_identifier = element.required_text("modelIdentifier");
    // It becomes part of a path.
    if (flags.model_identifier.empty() || flags.model_identifier.find_first_of("/\\") != std::string::npos)
      element.fail(fmt::format("modelIdentifier is \"{}\", which is not a C name", flags.model_identifier));
    flags.needs_execution_tool = element.flag("needsExecutionTool", false);
    flags.can_be_instantiated_only_once_per_process = element.flag("canBeInstantiatedOnlyOncePerProcess", false);
    flags.can_not_use_memory_management_functions = element.flag("canNotUseMemoryManagementFunctions", false);
    flags.can_get_and_set_fmu_state = element.flag("canGetAndSetFMUstate", false);
    flags.can_serialize_fmu_state = element.flag("canSerializeFMUstate", false);
    flags.provides_directional_derivative = element.flag("providesDirectionalDerivative", false);
    element.child("SourceFiles").each_child("File", [&](const Element& file) {
      flags.source_files.push_back(file.required_text("name"));
    });
  }

  void read_unit(const Element& element) {
    Unit unit;
    unit.name = element.required_text("name");
    const Element base = element.child("BaseUnit");
    unit.has_base = static_cast<bool>(base);
    if (base) {
      for (std::size_t i = 0; i < kBaseUnits.size(); ++i)
        unit.exponents[i] = base.number<int>(std::string(kBaseUnits[i]).c_str(), "a whole exponent").value_or(0);
      unit.factor = base.real("factor").value_or(1);
      unit.offset = base.real("offset").value_or(0);
      if (unit.factor == 0 || !std::isfinite(unit.factor) || !std::isfinite(unit.offset))
        base.fail(fmt::format("the unit \"{}\" has the factor {} and the offset {}, which convert nothing", unit.name,
                              unit.factor, unit.offset));
    }
    element.each_child("DisplayUnit", [&](const Element& display) {
      unit.display_units.push_back(
          {display.required_text("name"), display.real("factor").value_or(1), display.real("offset").value_or(0)});
    });
    if (!unit_names_.insert(unit.name).second) element.fail(fmt::format("the unit \"{}\" is defined twice", unit.name));
    result_.units.push_back(std::move(unit));
  }

  void read_type(const Element& element) {
    TypeDefinition type;
    type.name = element.required_text("name");
    type.text = element.text("description");
    const auto [kind, details] = type_child(element);
    type.type = kind;
    type.quantity = details.text("quantity");
    type.unit = details.text("unit");
    type.display_unit = details.text("displayUnit");
    type.min = details.real("min");
    type.max = details.real("max");
    type.nominal = details.real("nominal");
    details.each_child("Item", [&](const Element& item) {
      item.required_text("value");
      type.items.push_back({item.required_text("name"),
                            *item.number<std::int32_t>("value", "a whole number of 32 bits"),
                            item.text("description")});
    });
    if (!types_.emplace(type.name, result_.types.size()).second)
      element.fail(fmt::format("the type \"{}\" is defined twice", type.name));
    result_.types.push_back(std::move(type));
  }

  void read_variable(const Element& element) {
    Variable& variable = result_.variables.emplace_back();
    variable.name = element.required_text("name");
    if (!names_.insert(variable.name).second)
      element.fail(fmt::format("two variables have the name \"{}\"", variable.name));
    element.required_text("valueReference");
    variable.value_reference = *element.number<std::uint32_t>("valueReference", "a whole number of 32 bits");
    variable.text = element.text("description");
    variable.can_handle_multiple_set_per_time_instant = element.flag("canHandleMultipleSetPerTimeInstant", true);

    const auto [type, details] = type_child(element);
    variable.type = type;
    variable.causality = element.word<Causality>("causality", fmi2::kCausalityWords).value_or(Causality::local);
    variable.variability =
        element.word<Variability>("variability", fmi2::kVariabilityWords).value_or(default_variability(variable));
    if (variable.variability == Variability::continuous && type != Type::real)
      element.fail(fmt::format("\"{}\" is of type {}, so it cannot be continuous", variable.name, to_string(type)));
    variable.initial = element.word<Initial>("initial", fmi2::kInitialWords);
    if (!variable.initial) variable.initial = default_initial(variable.causality, variable.variability);

    variable.declared_type = details.text("declaredType");
    variable.quantity = details.text("quantity");
    variable.unit = details.text("unit");
    variable.display_unit = details.text("displayUnit");
    variable.min = details.real("min");
    variable.max = details.real("max");
    variable.nominal = details.real("nominal");
    variable.relative_quantity = details.flag("relativeQuantity", false);
    variable.reinit = details.flag("reinit", false);
    variable.start = read_start(details, type);
    if (const auto derivative = details.number<std::uint32_t>("derivative", "the index of a variable")) {
      if (*derivative == 0) details.fail("derivative is 0, but indices count from 1");
      variable.derivative_of = *derivative - 1;
    }
    if (!variable.declared_type.empty()) take_declared_type(element, variable);
    read_osmp(element, variable);
  }

  static Variability default_variability(const Variable& variable) {
    if (variable.causality == Causality::parameter || variable.causality == Causality::calculated_parameter)
      return Variability::fixed;
    return variable.type == Type::real ? Variability::continuous : Variability::discrete;
  }

  static Value read_start(const Element& details, Type type) {
    if (!details.has("start")) return {};
    switch (type) {
      case Type::real:
        return *details.real("start");
      case Type::integer:
      case Type::enumeration:
        return *details.number<std::int32_t>("start", "a whole number of 32 bits");
      case Type::boolean:
        return *details.parse_flag("start");
      case Type::string:
        return details.text("start");
    }
    return {};
  }

  void take_declared_type(const Element& element, Variable& variable) const {
    const auto known = types_.find(variable.declared_type);
    const TypeDefinition* type = known == types_.end() ? nullptr : &result_.types[known->second];
    if (type == nullptr)
      element.fail(fmt::format("\"{}\" is of declared type \"{}\", which <TypeDefinitions> does not define",
                               variable.name, variable.declared_type));
    if (type->type != variable.type)
      element.fail(fmt::format("\"{}\" is of type {}, but its declared type \"{}\" is of type {}", variable.name,
                               to_string(variable.type), type->name, to_string(type->type)));
    if (variable.quantity.empty()) variable.quantity = type->quantity;
    if (variable.unit.empty()) variable.unit = type->unit;
    if (variable.display_unit.empty()) variable.display_unit = type->display_unit;
    if (!variable.min) variable.min = type->min;
    if (!variable.max) variable.max = type->max;
    if (!variable.nominal) variable.nominal = type->nominal;
  }

  static void read_osmp(const Element& element, Variable& variable) {
    element.child("Annotations").each_child("Tool", [&](const Element& tool) {
      if (tool.text("name") != "net.pmsf.osmp") return;
      tool.each_child([&](const Element& part) {
        const std::string_view name = part.name();
        // The prefix of the namespace is the writer's choice.
        if (name.substr(name.find(':') + 1) != "osmp-binary-variable") return;
        variable.osmp = OsmpPart{part.required_text("name"), part.required_text("role"), part.text("mime-type")};
      });
    });
  }

  void check_derivatives(const Element& variables) const {
    for (const Variable& variable : result_.variables)
      if (variable.derivative_of && *variable.derivative_of >= result_.variables.size())
        variables.fail(fmt::format("\"{}\" is the derivative of variable {}, but there are only {}", variable.name,
                                   *variable.derivative_of + 1, result_.variables.size()));
  }

  /// The variable of an index of ModelStructure. Notes an index without a variable: some tools write 0, and an FMU runs
  /// without its ModelStructure.
  std::optional<std::size_t> index(const Element& element, std::string_view text) {
    const auto value = parse_number<std::size_t>(text);
    if (!value) element.fail(fmt::format("\"{}\" is not an index of a variable", text));
    if (*value != 0 && *value <= result_.variables.size()) return *value - 1;
    result_.structure_faults.push_back(element.located(
        fmt::format("\"{}\" is not an index of a variable; they go from 1 to {}", text, result_.variables.size())));
    return std::nullopt;
  }

  /// The dependencies of an unknown; none (it may depend on everything) if one of them has no variable.
  std::optional<std::vector<std::size_t>> read_dependencies(const Element& element) {
    if (!element.has("dependencies")) return std::nullopt;
    std::vector<std::size_t> dependencies;
    bool all_known = true;
    for (const std::string& word : words_of(element.text("dependencies"))) {
      if (const auto variable = index(element, word)) {
        dependencies.push_back(*variable);
      } else {
        all_known = false;
      }
    }
    if (!all_known) return std::nullopt;
    return dependencies;
  }

  std::vector<Unknown> read_unknowns(const Element& list) {
    std::vector<Unknown> unknowns;
    list.each_child("Unknown", [&](const Element& element) {
      const auto variable = index(element, element.required_text("index"));
      Unknown unknown;
      unknown.dependencies = read_dependencies(element);
      unknown.dependency_kinds = words_of(element.text("dependenciesKind"));
      if (!unknown.dependency_kinds.empty() &&
          unknown.dependency_kinds.size() != words_of(element.text("dependencies")).size())
        element.fail("dependenciesKind and dependencies have different lengths");
      if (!unknown.dependencies) unknown.dependency_kinds.clear();
      if (!variable) return;
      unknown.variable = *variable;
      unknowns.push_back(std::move(unknown));
    });
    return unknowns;
  }

  Element root_;
  ModelDescription result_;
  std::unordered_set<std::string_view> names_;  // of the variables, which stay in their place
  std::set<std::string> unit_names_;
  std::unordered_map<std::string, std::size_t> types_;  // name, index; descriptions may have thousands
};

ModelDescription read_utf8(std::string text, std::string_view source) {
  const Document document(text, source);
  std::string().swap(text);  // the document holds a copy
  return XmlReader(document).read();
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw Error(
        ErrorCode::file_not_found,
        fmt::format("{}: cannot be opened; modelDescription.xml must be at the root of the archive", file.string()));
  }
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

ModelDescription read_xml_text(std::string_view text, std::string_view source) {
  return read_utf8(xml_as_utf8(text, source), source);
}

ModelDescription read_xml(const std::filesystem::path& file) {
  // The file's bytes are freed before the text is parsed: a description may have a million variables.
  return read_utf8(xml_as_utf8(bytes_of(file), file.string()), file.string());
}

}  // namespace mebots::modeldesc
