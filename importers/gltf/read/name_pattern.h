#pragma once
#include <fnmatch.h>

#include <string>

namespace patchlight {

/// Whether a name is meant by a pattern of the job: a glob, or the name itself even if it holds a glob's characters.
inline bool matches(const std::string& pattern, const std::string& name) {
  return pattern == name || fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

}  // namespace patchlight
