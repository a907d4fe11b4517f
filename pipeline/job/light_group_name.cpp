#include "pipeline/job/light_group_name.h"

#include <algorithm>

namespace patchlight {

std::string light_group_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '/' || c == '\0'; }, '_');
  return name == "." ? "_" : name;
}

}  // namespace patchlight
