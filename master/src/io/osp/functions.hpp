// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/ssp/xml_file.hpp"

#include <map>
#include <string>
#include <vector>

namespace mebots::master::osp {

struct OspVariable {
  std::string simulator;
  std::string variable;

  std::string text() const { return simulator + "." + variable; }
};

/// A connection from a source of a function's input to a target of its output. It adds `factor * from + offset` to the
/// variable `to`. Such connections replace the function.
struct FunctionLink {
  OspVariable from;
  OspVariable to;
  double factor = 1;
  double offset = 0;
  pugi::xml_node node;  ///< element of the connection that ends at `to`
};

/// Selects connections of single variables or of variable groups.
enum class Ends { variable, group };

/// Converts the <Functions> of an OspSystemStructure.xml: LinearTransformation, Sum and VectorSum. Functions are
/// replaced by factors, offsets and sums of connections. This gives the same results, because in libcosim, inputs and
/// outputs of a function belong to the same communication point. Throws InputError with file, line and element of a
/// mistake.
class Functions {
 public:
  explicit Functions(const ssp::XmlFile& file) : file_(&file) {}

  /// Reads the functions. `functions` is null if the file has none.
  void read(pugi::xml_node functions);
  /// Adds a connection of variables with a <Signal> or <SignalGroup> of a function.
  void connect(pugi::xml_node signal, const std::vector<OspVariable>& variables, Ends ends);
  /// Returns the links that replace all functions. Must be called after the last connect(). Throws InputError if an
  /// input is not connected.
  std::vector<FunctionLink> links() const;

 private:
  /// A function of the file. In a VectorSum, each input and output has several elements. In the other functions, it has
  /// one.
  struct Function {
    pugi::xml_node node;
    bool indexed = false;  // true if the inputs have the names in[0], in[1] and so on, instead of `in`
    // True for a VectorSum. Its signals have elements, such as in[0][2] and out[2], and can be connected as groups.
    bool is_vector = false;
    double factor = 1;
    double offset = 0;
    // inputs[i][j] is the variable that is connected to element j of input i. Its `simulator` is empty if there is no
    // connection.
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
