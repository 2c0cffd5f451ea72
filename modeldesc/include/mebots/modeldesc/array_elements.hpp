// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <cstdint>
#include <map>

namespace mebots::modeldesc {

/// Limits the total number of array elements. A description with more elements is rejected.
inline constexpr std::size_t kMostElements = 1'000'000;

/// Limits the total number of dependencies between array elements. If each element of one array depends on each element
/// of another array, the number is the product of both sizes. A description with more dependencies is rejected.
inline constexpr std::size_t kMostDependencies = 400'000'000;

/// Maps the value reference of a structural parameter to its value.
using StructuralValues = std::map<std::uint32_t, std::uint64_t>;

/// Returns the description with each array of FMI 3.0 replaced by its elements, as variables named `y[1]`, `m[2,3]`. An
/// element has a value reference that no other variable has. `Variable::fmi3->element` states the array to which it
/// belongs, the array's value reference in the FMU, and its index in the array. Sizes come from `values`, or else from
/// the start values of the structural parameters. If an array has another size than its declared start value, the start
/// value is left out, and the FMU uses its internal value. Throws Error if there are more than kMostElements elements
/// or more than kMostDependencies dependencies, or if a derivative and its state have different numbers of elements.
ModelDescription with_elements(const ModelDescription& description, const StructuralValues& values = {});

/// Returns the name of an element of an array with these sizes, such as "y[2,3]". `index` is in row-major order, from
/// 0.
std::string element_name(const std::string& array, const std::vector<std::uint64_t>& sizes, std::size_t index);

/// Returns the size of each dimension of an array; empty for a scalar. A size comes from `values` if it contains the
/// structural parameter, otherwise from the parameter's start value.
std::vector<std::uint64_t> sizes_of(const ModelDescription& description, const Variable& variable,
                                    const StructuralValues& values = {});

}  // namespace mebots::modeldesc
