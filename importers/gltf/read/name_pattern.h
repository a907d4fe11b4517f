#pragma once
#include <fnmatch.h>

#include <string>

namespace patchlight {

/// Whether a pattern of the job matches a name: as a glob, or literally even if it contains characters of globs.
inline bool matches(const std::string& pattern, const std::string& name) {
  return pattern == name || fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

}  // namespace patchlight
