#pragma once
#include <memory>
#include <string>

namespace patchlight {

/// An OpenGL 4.5 core context without a window, current on the thread that made it: on a GPU where EGL offers one, else
/// on Mesa's software rasteriser.
class GlContext {
 public:
  /// Throws: Error (unavailable) where no such context can be had.
  GlContext();
  ~GlContext();

  /// As the driver names itself.
  std::string renderer() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Compiles and links a program. A fault of the sources asserts.
unsigned link_program(const char* vertex_source, const char* fragment_source);

}  // namespace patchlight
