// SPDX-License-Identifier: Apache-2.0
#include "io/osp/osp.hpp"

#include "io/fmu_archive.hpp"
#include "io/ssp/files.hpp"
#include "io/ssp/xml_file.hpp"
#include "mebots/data/node.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"
#include "mebots/text_file.hpp"

#include "functions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace mebots::master {
namespace {

using namespace ssp;
using modeldesc::Causality;
using osp::OspVariable;
using Json = nlohmann::ordered_json;

class OspReader {
 public:
  explicit OspReader(const std::filesystem::path& path)
      : folder_(std::filesystem::absolute(path).parent_path()), file_(remember(text_of(path)), path.string()) {}

  SspConfig read() {
    const auto root = file_.root();
    if (local_name(root) != "OspSystemStructure") file_.fail(root, "the root element must be OspSystemStructure");
    functions_.read(child(root, "Functions"));
    read_times(root);
    result_.config["instances"] = Json::object();
    result_.places["/instances"] = file_.place(root);
    for (const auto simulator : children(child(root, "Simulators"), "Simulator")) read_simulator(simulator);
    result_.config["connections"] = Json::array();
    for (const auto connection : child(root, "Connections").children()) {
      if (connection.type() == pugi::node_element) read_connection(connection);
    }
    for (const auto& link : functions_.links()) connect_through(link);
    leave_out_values_of_connected();
    result_.source = std::move(bytes_);
    return std::move(result_);
  }

 private:
  std::string remember(std::string bytes) {
    bytes_ += bytes;
    return bytes;
  }

  std::optional<double> number_in(pugi::xml_node root, const char* name) const {
    const auto element = child(root, name);
    if (!element) return std::nullopt;
    const auto value = parse_number(element.text().get());
    if (!value) file_.fail(element, fmt::format("\"{}\" is not a finite number", element.text().get()));
    return value;
  }

  void read_times(pugi::xml_node root) {
    for (const auto& [element, key] :
         {std::pair("StartTime", "start_time"), std::pair("EndTime", "stop_time"), std::pair("BaseStepSize", "step")}) {
      const auto value = number_in(root, element);
      if (!value) continue;
      result_.config[key] = *value;
      result_.places[data::pointer_step(key)] = file_.place(child(root, element));
    }
    const auto algorithm = child(root, "Algorithm");
    const std::string_view name = algorithm.text().get();
    if (algorithm && name != "fixedStep") {
      result_.notices.push_back(
          fmt::format("{}: the algorithm \"{}\" is ignored; all simulators step with the base step. For steps of "
                      "variable length, write a config with `mebots convert` and add \"step_control\"",
                      file_.place(algorithm), name));
    }
  }

  void read_simulator(pugi::xml_node node) {
    const auto name = file_.required(node, "name");
    auto& instance = result_.config["instances"][name];
    if (!instance.is_null()) file_.fail(node, fmt::format("the simulator \"{}\" occurs twice", name));
    const auto pointer = "/instances" + data::pointer_step(name);
    result_.places[pointer] = file_.place(node);
    const auto path = read_source(node, name, instance);
    if (node.attribute("stepSize")) {
      instance["step"] = step_of(node, name);
      result_.places[pointer + "/step"] = file_.place(node);
    }
    for (const auto value : children(child(node, "InitialValues"), "InitialValue")) {
      const auto variable = file_.required(value, "variable");
      instance["parameters"][variable] = initial_value(value);
      result_.places[pointer + "/parameters" + data::pointer_step(variable)] = file_.place(value);
    }
    const auto* description = descriptions_.find(path);
    if (description == nullptr) throw_reason(node, path);
    fmus_.emplace(name, OspFmu{description, path});
  }

  /// Returns the path of the FMU, and stores it in `instance`. If `source` is a URI such as proxyfmu://HOST?file=PATH,
  /// also selects a separate process for the instance.
  std::filesystem::path read_source(pugi::xml_node node, const std::string& name, Json& instance) {
    const auto source = file_.required(node, "source");
    const auto uri = parse_file_uri(source);
    if (!uri) file_.fail(node, fmt::format("the source \"{}\" is not a file", source));
    if (uri->has_backslashes) {
      result_.notices.push_back(
          fmt::format("{}: the backslashes of the source \"{}\" are read as slashes", file_.place(node), source));
    }
    auto path = (folder_ / uri->path).lexically_normal();
    instance["fmu"] = path.string();
    if (uri->by_proxy) {
      instance["process"] = "own";
      result_.notices.push_back(
          fmt::format("{}: \"{}\" runs on this machine, in its own process; the proxy at {} is not used",
                      file_.place(node), name, *uri->by_proxy));
    }
    return path;
  }

  /// Returns the step of a simulator, rounded down to a multiple of the base step as in libcosim.
  double step_of(pugi::xml_node node, const std::string& name) {
    const auto step = file_.number(node, "stepSize", 0);
    if (!result_.config.contains("step")) return step;
    const auto base = result_.config["step"].get<double>();
    constexpr double kRounding = 1e-9;  // permits rounding errors of decimal numbers
    const auto multiple = std::max(1.0, std::floor(step / base + kRounding));
    if (!(step > 0) || !(base > 0) || std::abs(step - multiple * base) <= kRounding * base) return step;
    result_.notices.push_back(
        fmt::format("{}: the step {} s of \"{}\" is not a multiple of the base step {} s; {} s is used",
                    file_.place(node), step, name, base, multiple * base));
    return multiple * base;
  }

  /// Throws the error that occurs when the description of this FMU is read. The error contains the place of `node`.
  [[noreturn]] void throw_reason(pugi::xml_node node, const std::filesystem::path& path) const {
    try {
      static_cast<void>(read_fmu_description(path));
    } catch (const InputError& error) {
      file_.fail(node, error.what());
    }
    file_.fail(node, fmt::format("{}: the description of this FMU cannot be read", path.string()));
  }

  Json initial_value(pugi::xml_node node) const {
    for (const auto element : node.children()) {
      const auto kind = local_name(element);
      if (element.type() != pugi::node_element) continue;
      auto text = file_.required(element, "value");
      if (kind == "Real") return file_.number(element, "value", 0);
      if (kind == "Boolean") return file_.flag(element, "value", false);
      if (kind == "String") return text;
      if (kind != "Integer" && kind != "Enumeration")
        file_.fail(element, "Real, Integer, Boolean or String is expected");
      const auto number = parse_number(text);
      constexpr auto kMost = std::numeric_limits<std::int32_t>::max();
      if (!number || std::abs(*number) > kMost || *number != std::trunc(*number)) {
        file_.fail(element, fmt::format("\"{}\" is not a 32-bit whole number", text));
      }
      return static_cast<std::int32_t>(*number);
    }
    file_.fail(node, "the value is missing");
  }

  void read_connection(pugi::xml_node node) {
    const auto kind = local_name(node);
    if (kind == "VariableConnection") {
      const auto ends = two(node, "Variable");
      connect(node, {simulator_of(ends[0]), file_.required(ends[0], "name")},
              {simulator_of(ends[1]), file_.required(ends[1], "name")});
    } else if (kind == "VariableGroupConnection") {
      const auto ends = two(node, "VariableGroup");
      const auto first = group(ends[0]);
      const auto second = group(ends[1]);
      if (first.size() != second.size()) {
        file_.fail(node, fmt::format("one group has {} variables and the other {}", first.size(), second.size()));
      }
      for (std::size_t i = 0; i < first.size(); ++i) connect(node, first[i], second[i]);
    } else if (kind == "SignalConnection") {
      const auto end = one(node, "Variable");
      const OspVariable variable{simulator_of(end), file_.required(end, "name")};
      functions_.connect(one(node, "Signal"), {variable}, osp::Ends::variable);
    } else if (kind == "SignalGroupConnection") {
      functions_.connect(one(node, "SignalGroup"), group(one(node, "VariableGroup")), osp::Ends::group);
    } else {
      file_.fail(node, fmt::format("{} is not a connection", kind));
    }
  }

  pugi::xml_node one(pugi::xml_node node, const char* element) const {
    const auto ends = children(node, element);
    if (ends.size() != 1) {
      file_.fail(node, fmt::format("one element {} is expected here, but there are {}", element, ends.size()));
    }
    return ends.front();
  }

  std::vector<pugi::xml_node> two(pugi::xml_node node, const char* element) const {
    auto ends = children(node, element);
    if (ends.size() != 2)
      file_.fail(node, fmt::format("two elements {} are expected here, but there are {}", element, ends.size()));
    return ends;
  }

  std::string simulator_of(pugi::xml_node end) const {
    auto name = file_.required(end, "simulator");
    if (fmus_.count(name) == 0) {
      std::vector<std::string> names;
      for (const auto& [known, fmu] : fmus_) names.push_back(known);
      file_.fail(end, fmt::format("there is no simulator \"{}\". {}", name, suggest(name, names)));
    }
    return name;
  }

  Causality causality(pugi::xml_node node, const OspVariable& end) const {
    const auto* variable = fmus_.at(end.simulator).description->find(end.variable);
    if (variable == nullptr)
      file_.fail(node, fmt::format("the FMU of \"{}\" has no variable \"{}\"", end.simulator, end.variable));
    return variable->causality;
  }

  void connect(pugi::xml_node node, const OspVariable& one, const OspVariable& other) {
    const bool onwards = causality(node, one) == Causality::output && causality(node, other) == Causality::input;
    const bool back = causality(node, one) == Causality::input && causality(node, other) == Causality::output;
    if (!onwards && !back) {
      file_.fail(node, fmt::format("one of \"{}\" and \"{}\" must be an output, and the other one an input", one.text(),
                                   other.text()));
    }
    add(node, {{"from", (onwards ? one : other).text()}, {"to", (onwards ? other : one).text()}},
        onwards ? other : one);
  }

  void add(pugi::xml_node node, Json connection, const OspVariable& to) {
    auto& connections = result_.config["connections"];
    result_.places[fmt::format("/connections/{}", connections.size())] = file_.place(node);
    connections.push_back(std::move(connection));
    ends_.push_back(to);
  }

  /// Connects two variables through a function. Functions do not convert units.
  void connect_through(const osp::FunctionLink& link) {
    for (const auto& [variable, wanted] :
         {std::pair(&link.from, Causality::output), std::pair(&link.to, Causality::input)}) {
      if (causality(link.node, *variable) == wanted) continue;
      file_.fail(link.node, fmt::format("\"{}\" must be an {} of its FMU for this connection with a function",
                                        variable->text(), to_string(wanted)));
    }
    if (link.factor == 0) return set(link.node, link.to, link.offset);
    Json connection = {{"from", link.from.text()}, {"to", link.to.text()}};
    if (link.factor != 1) connection["factor"] = link.factor;
    if (link.offset != 0) connection["offset"] = link.offset;
    connection["convert_units"] = false;
    connection["sum"] = true;  // also for a single term, so that the value is computed at communication points
    add(link.node, std::move(connection), link.to);
  }

  void set(pugi::xml_node node, const OspVariable& variable, double value) {
    result_.config["instances"][variable.simulator]["parameters"][variable.variable] = value;
    result_.places["/instances" + data::pointer_step(variable.simulator) + "/parameters" +
                   data::pointer_step(variable.variable)] = file_.place(node);
  }

  void leave_out_values_of_connected() {
    for (const auto& end : ends_) {
      auto& instance = result_.config["instances"][end.simulator];
      if (!instance.contains("parameters") || instance["parameters"].erase(end.variable) == 0) continue;
      result_.notices.push_back(
          fmt::format("{}: the initial value of \"{}\" is ignored, because the variable is connected",
                      result_.places["/instances" + data::pointer_step(end.simulator) + "/parameters" +
                                     data::pointer_step(end.variable)],
                      end.text()));
    }
  }

  /// Returns the variables of a group and its nested groups in the order of the file.
  std::vector<OspVariable> group(pugi::xml_node end) {
    const auto simulator = simulator_of(end);
    const auto name = file_.required(end, "name");
    const auto& fmu = fmus_.at(simulator);
    const auto described = fmu.description->model_name + "_OspModelDescription.xml";
    auto path = folder_ / described;
    if (!is_there(path)) path = fmu.archive.parent_path() / described;
    if (!is_there(path)) {
      file_.fail(end, fmt::format("the groups of \"{}\" are unknown: {} is not in the folder of the system or the FMU",
                                  simulator, described));
    }
    const XmlFile groups(remember(text_of(path)), path.string());
    const auto found = child(groups.root(), "VariableGroups").find_child([&](pugi::xml_node one) {
      return name == one.attribute("name").value();
    });
    if (!found) file_.fail(end, fmt::format("{} has no group \"{}\"", path.string(), name));
    std::vector<OspVariable> result;
    collect(groups, found, simulator, result);
    return result;
  }

  void collect(const XmlFile& groups, pugi::xml_node node, const std::string& simulator,
               std::vector<OspVariable>& result) const {
    for (const auto one : node.children()) {
      if (one.type() != pugi::node_element) continue;
      if (local_name(one) == "Variable") {
        result.push_back({simulator, groups.required(one, "ref")});
      } else {
        collect(groups, one, simulator, result);
      }
    }
  }

  std::filesystem::path folder_;
  std::string bytes_;
  XmlFile file_;
  SspConfig result_;
  struct OspFmu {
    const modeldesc::ModelDescription* description;
    std::filesystem::path archive;
  };

  osp::Functions functions_{file_};
  FmuDescriptions descriptions_;
  std::map<std::string, OspFmu> fmus_;
  std::vector<OspVariable> ends_;  // ends of connections
};

}  // namespace

SspConfig read_osp(const std::filesystem::path& file) {
  return OspReader(file).read();
}

}  // namespace mebots::master
