#pragma once
#include <string>
#include <vector>

namespace patchlight {

/// The element of `words` (not empty) with the smallest edit distance from `word`.
std::string nearest_word(const std::vector<std::string>& words, const std::string& word);

}  // namespace patchlight
