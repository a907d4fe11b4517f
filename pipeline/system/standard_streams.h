#pragma once
#include <string_view>

namespace patchlight {

/// Opens standard streams that are closed, so that no file opened later takes the number of one and receives messages.
/// Writing to them still fails. Call it before anything else is opened.
void open_standard_streams();

/// Writes text to standard output at once. Throws: Error (io_error) if it cannot be written.
void print(std::string_view text);

/// Writes text to standard error at once. A failure is ignored, since it could not be reported either.
void print_error(std::string_view text);

}  // namespace patchlight
