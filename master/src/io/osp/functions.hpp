// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/ssp/xml_file.hpp"

#include <map>
#include <string>
#include <vector>

namespace mebots::master::osp {

/// A variable of a simulator.
struct OspVariable {
  std::string simulator;
  std::string variable;

  std::string text() const { return simulator + "." + variable; }
};

/// The effect of a function's input on one variable. The variable's value is the sum of `factor * from + offset` over
/// all links to this variable.
struct FunctionLink {
  OspVariable from;
  OspVariable to;
  double factor = 1;
  double offset = 0;
  pugi::xml_node node;  ///< the XML connection that ends at `to`
};

/// The other end of a function's connection: a variable or a group of variables.
enum class Ends { variable, group };

/// The <Functions> of an OspSystemStructure.xml: LinearTransformation, Sum and VectorSum. In libcosim, a function reads
/// its inputs and provides its outputs at the same communication point. Therefore each function is converted into
/// factors, offsets and sums of connections. Throws InputError with file, line and element.
class Functions {
 public:
  explicit Functions(const ssp::XmlFile& file) : file_(&file) {}

  /// `functions` is null if the file has none.
  void read(pugi::xml_node functions);
  /// Connects variables with a <Signal> or <SignalGroup>.
  void connect(pugi::xml_node signal, const std::vector<OspVariable>& variables, Ends ends);
  /// Returns the effect of all functions. Must be called after the last connect(). Each input of a function must be
  /// connected.
  std::vector<FunctionLink> links() const;

 private:
  /// A function of the file. In a VectorSum, `in[i]` and `out` are vectors. In LinearTransformation and Sum, they have
  /// one element.
  struct Function {
    pugi::xml_node node;
    bool indexed = false;    // its inputs are in[0], in[1] ..., not `in`
    bool is_vector = false;  // its signals have elements in[0][2] and out[2], and can be connected as groups
    double factor = 1;
    double offset = 0;
    std::vector<std::vector<OspVariable>> inputs;  // by input and element; an empty simulator means not connected
    struct Target {
      OspVariable variable;
      pugi::xml_node node;
    };
    std::vector<std::vector<Target>> outputs;  // by element
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
