#pragma once
#include <memory>
#include <string>

namespace patchlight {

/// An OpenGL 4.5 core context without a window, current on the thread that created it: on a GPU if EGL offers one, else
/// on Mesa's software rasteriser.
class GlContext {
 public:
  /// Throws: Error (unavailable) if there is no such context.
  GlContext();
  ~GlContext();

  /// The driver's GL_RENDERER string.
  std::string renderer() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Compiles and links a program. Aborts if a source has errors.
unsigned link_program(const char* vertex_source, const char* fragment_source);

}  // namespace patchlight
