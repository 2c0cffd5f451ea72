// SPDX-License-Identifier: Apache-2.0
#include "record/sink/hdf5_parts.hpp"

#include <algorithm>

namespace mebots::master::hdf5 {

std::mutex& library() {
  static std::mutex mutex;
  return mutex;
}

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), &H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

bool put_attribute(hid_t object, const char* name, const std::string& text) {
  const Handle type = text_type();
  const Handle space(H5Screate(H5S_SCALAR), &H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), &H5Aclose);
  const char* content = text.c_str();
  return H5Awrite(attribute, type, &content) >= 0;
}

std::string without_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '/', '|');
  return name;
}

}  // namespace mebots::master::hdf5
