// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <cstdint>
#include <map>

namespace mebots::modeldesc {

/// The greatest total number of array elements. Descriptions with more elements are rejected.
inline constexpr std::size_t kMostElements = 1'000'000;

/// The greatest total number of dependencies between array elements. Descriptions with more dependencies are rejected.
/// If each element of one array depends on each element of another, the number is the product of both sizes.
inline constexpr std::size_t kMostDependencies = 400'000'000;

/// Maps the value reference of a structural parameter to its value.
using StructuralValues = std::map<std::uint32_t, std::uint64_t>;

/// Returns the description with each array of FMI 3.0 replaced by its elements, as variables named `y[1]`, `m[2,3]`.
/// Each element has a unique value reference. `Variable::fmi3->element` contains the element's array, the array's value
/// reference in the FMU, and the index in the array. The values of structural parameters in `values` set the sizes; a
/// parameter that is missing has its start value. If the size of an array differs from the size of its declared start
/// value, the elements have no start value, and the FMU uses its internal value. Throws Error if there are more than
/// kMostElements elements or more than kMostDependencies dependencies, or if a derivative and its state have different
/// numbers of elements.
ModelDescription with_elements(const ModelDescription& description, const StructuralValues& values = {});

/// Returns the name of an array's element, such as "y[2,3]". `sizes` are the array's sizes. `index` is in row-major
/// order, from 0.
std::string element_name(const std::string& array, const std::vector<std::uint64_t>& sizes, std::size_t index);

/// Returns the size of each dimension of an array; empty for a scalar. If `values` lacks a structural parameter, its
/// start value is used.
std::vector<std::uint64_t> sizes_of(const ModelDescription& description, const Variable& variable,
                                    const StructuralValues& values = {});

}  // namespace mebots::modeldesc
