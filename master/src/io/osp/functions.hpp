// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/ssp/xml_file.hpp"

#include <map>
#include <string>
#include <vector>

namespace mebots::master::osp {

/// Names a variable of a simulator.
struct OspVariable {
  std::string simulator;
  std::string variable;

  std::string text() const { return simulator + "." + variable; }
};

/// States how an input of a function affects one variable. The value of the variable `to` is the sum of `factor * from
/// + offset` over all links to it.
struct FunctionLink {
  OspVariable from;
  OspVariable to;
  double factor = 1;
  double offset = 0;
  pugi::xml_node node;  ///< the XML element of the connection that ends at `to`
};

/// States whether a connection connects a function with single variables or with groups of variables.
enum class Ends { variable, group };

/// Converts the <Functions> of an OspSystemStructure.xml: LinearTransformation, Sum and VectorSum. In libcosim, a
/// function reads its inputs and provides its outputs at the same communication point. Therefore each function can be
/// replaced by factors, offsets and sums of connections. Throws InputError with file, line and element if there is a
/// mistake.
class Functions {
 public:
  explicit Functions(const ssp::XmlFile& file) : file_(&file) {}

  /// Reads the functions. `functions` is null if the file has none.
  void read(pugi::xml_node functions);
  /// Adds a connection between variables of simulators and a <Signal> or <SignalGroup> of a function.
  void connect(pugi::xml_node signal, const std::vector<OspVariable>& variables, Ends ends);
  /// Returns links that replace all functions. Must be called after the last connect(). Every input of a function must
  /// be connected.
  std::vector<FunctionLink> links() const;

 private:
  /// A function that the file defines. In a VectorSum, each `in[i]` and `out` are vectors. In LinearTransformation and
  /// Sum, they have one element.
  struct Function {
    pugi::xml_node node;
    bool indexed = false;  // true if the inputs are named in[0], in[1] ... instead of `in`
    // True if signals have elements, such as in[0][2] and out[2], and can be connected as groups.
    bool is_vector = false;
    double factor = 1;
    double offset = 0;
    // Indexed by input and element; an empty simulator means that the element is not connected.
    std::vector<std::vector<OspVariable>> inputs;
    struct Target {
      OspVariable variable;
      pugi::xml_node node;
    };
    std::vector<std::vector<Target>> outputs;  // indexed by element
  };

  struct Signal {
    bool is_output = false;
    std::size_t input = 0;
    std::size_t element = 0;
  };

  Function& function_of(pugi::xml_node signal);
  std::size_t count(pugi::xml_node node, const char* attribute) const;
  Signal parse(pugi::xml_node signal, const Function& function, Ends ends) const;

  const ssp::XmlFile* file_;
  std::map<std::string, Function> functions_;
  std::vector<std::string> order_;
};

}  // namespace mebots::master::osp
