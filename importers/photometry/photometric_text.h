#pragma once
#include <string>
#include <string_view>

namespace patchlight {

/// A photometric file, read line by line or number by number, for messages that name the line.
class PhotometricText {
 public:
  /// `name`: for messages. The text must outlive this object.
  PhotometricText(std::string_view text, std::string name);

  bool at_end() const { return rest_.empty(); }

  /// Takes the rest of the line, without spaces at its ends. Throws: Error (bad_data) at the end of the file, naming
  /// `what` is missing.
  std::string_view line(const std::string& what);

  /// Takes the next number, on this line or a later one; they are separated by spaces, commas or line ends.
  /// Throws: Error (bad_data) if there is no finite number.
  double number(const std::string& what);

  /// Takes a line that begins with a number, in which a comma may be the decimal point. Throws: likewise.
  double line_number(const std::string& what);

  /// A whole number in [low, high] by one of the two ways above. Throws: Error (bad_data) for others.
  int whole(double value, const std::string& what, int low, int high) const;

  /// Refuses the line that the last number or line was taken from. Throws: Error (bad_data).
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  void take(std::size_t count);

  std::string_view rest_;
  const std::string name_;
  int line_ = 1;       ///< That `rest_` begins on.
  int last_line_ = 1;  ///< That was taken from.
};

}  // namespace patchlight
