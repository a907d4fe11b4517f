#pragma once
#include <stdexcept>
#include <string>

namespace patchlight {

/// Process exit codes, from sysexits.h.
enum class ExitCode : int {
  ok = 0,
  usage = 64,
  bad_data = 65,
  missing_input = 66,
  unavailable = 69,
  internal = 70,
  cannot_create = 73,
  io_error = 74,
  interrupted = 75,
  over_limit = 77,
  bad_config = 78,
};

/// An error that the user can correct. what() reads "WHAT (WHERE): HOW TO MEND".
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& what, const std::string& where, const std::string& mend)
      : std::runtime_error(what + (where.empty() ? "" : " (" + where + ")") + (mend.empty() ? "" : ": " + mend)),
        code_(code) {}

  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace patchlight
