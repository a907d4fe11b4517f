#pragma once
#include <string>
#include <vector>

namespace patchlight {

/// The one of `words`, of which there is at least one, that takes the fewest edits to make from `word`.
std::string nearest_word(const std::vector<std::string>& words, const std::string& word);

}  // namespace patchlight
