// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common.hpp"

#include <vector>

namespace mebots::master::ssp {

/// Files and definitions that the bindings of an element may refer to.
struct BindingContext {
  const Source& source;
  const XmlFile& ssd;
  const Definitions& definitions;  ///< of the SSD
  std::filesystem::path fmu;       ///< of a component: sourceBase="component" begins in it
};

/// All values of an element's <ParameterBindings> (SSP 2.0, 5.3.3), SSV and SSM inline or in files, in their order.
std::vector<Parameter> read_parameter_bindings(const BindingContext& context, pugi::xml_node element);

}  // namespace mebots::master::ssp
