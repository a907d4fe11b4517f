#include "solver/hemicube/patch_id_renderer.h"

#include <ImathBox.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "pipeline/model/error.h"
#include "pipeline/optics/sampling/quad_shape.h"
#include "solver/hemicube/patch_id_shaders.h"

namespace patchlight {

namespace {

struct QuadSide {
  std::int32_t first = 0;  ///< Patch, from 1; negative: ~ the number of a region's cell.
  std::int32_t columns = 0, rows = 0;
};
struct Vertex {
  Vec3f position;
  Vec2f st, shape;
  QuadSide front, back;
  std::int32_t mask;  ///< Index of the alpha mask record.
};

// Records in the std430 layout of the shaders.
struct SphereRecord {
  std::array<float, 4> ball;
  std::array<std::int32_t, 4> rings;  ///< First ring and number of rings of the outside, then of the inside.
};

struct AlphaMaskRecord {
  std::array<float, 8> texcoords;
  std::array<float, 4> alphas;
  std::array<std::int32_t, 4> image;
  std::array<std::int32_t, 2> wraps;
  std::array<float, 2> factor;
};

struct CutLineRecord {
  std::array<float, 4> distance;
  std::array<std::int32_t, 2> sides;
  std::array<std::int32_t, 2> unused{};
};

/// A program of quads.
unsigned link_quad_program(bool masked, bool cut, bool regions) {
  const std::string defines = std::string(masked ? "#define MASKED\n" : "") + (cut ? "#define CUT\n" : "") +
                              (regions ? "#define REGIONS\n" : "");
  const auto with_defines = [&](const std::string& shader) {
    const std::size_t first_line = shader.find('\n') + 1;
    return shader.substr(0, first_line) + defines + shader.substr(first_line);
  };
  return link_program(with_defines(kQuadVertexShader).c_str(), with_defines(kQuadFragmentShader).c_str());
}

template <class T>
void upload(unsigned target, const std::vector<T>& values) {
  unsigned buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(target, buffer);
  glBufferData(target, GLsizeiptr(std::max<std::size_t>(values.size(), 1) * sizeof(T)), values.data(), GL_STATIC_DRAW);
}

template <class T>
void upload_storage(unsigned binding, const std::vector<T>& values) {
  unsigned buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer);
  glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(std::max<std::size_t>(values.size(), 1) * sizeof(T)), values.data(),
               GL_STATIC_DRAW);
}

QuadSide quad_side(const PatchLookup& lookup, std::int32_t primitive) {
  if (primitive < 0) return {};
  const PatchLookup::Row& row = lookup.row(primitive, 0);
  return {row.in_region ? ~row.first : row.first + 1, row.cells, lookup.rows(primitive)};
}

Vec3d patch_bounds_center(const PatchSet& scene) {
  Imath::Box3d bounds;
  for (const Patch& patch : scene.patches) bounds.extendBy(patch.center);
  return bounds.center();
}

/// Intangible lamps, and what lets light pass.
bool is_not_drawn(const PatchSet& scene, const Primitive& p) {
  return p.intangible || lets_light_pass(scene, p);
}

}  // namespace

PatchIdRenderer::PatchIdRenderer(const PatchSet& scene) : origin_(patch_bounds_center(scene)) {
  const PatchLookup lookup(scene);
  sphere_program_ = link_program(kSphereVertexShader, kSphereFragmentShader);
  opaque_ = upload_quads(scene, lookup, false);
  if (!scene.masks.empty()) {
    masked_ = upload_quads(scene, lookup, true);
    upload_masks(scene);
  }
  upload_spheres(scene, lookup);
  if (!scene.cuts.empty()) upload_cuts(lookup);
  if (!lookup.region_cells().empty()) upload_storage(7, lookup.region_cells());
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glClearDepth(0.0);
  glEnable(GL_SCISSOR_TEST);
}

PatchIdRenderer::~PatchIdRenderer() = default;

PatchIdRenderer::Quads PatchIdRenderer::upload_quads(const PatchSet& scene, const PatchLookup& lookup,
                                                     bool masked) const {
  std::vector<Vertex> vertices;
  std::int32_t masks = 0;
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.shape != Primitive::Shape::quad || (p.back >= 0 && p.back < i) || (p.mask >= 0) != masked ||
        is_not_drawn(scene, p))
      continue;
    const Vec2f shape = quad_shape(p.corners);
    const std::array<Vec2f, 4> st{Vec2f(0, 0), Vec2f(1, 0), shape, Vec2f(0, 1)};
    const std::array<int, 6> order{0, 1, 2, 0, 2, 3};
    const QuadSide front = quad_side(lookup, i), back = quad_side(lookup, p.back);
    for (int k = 0; k < (p.is_triangle() ? 3 : 6) && !p.region; ++k)
      vertices.push_back({to_local(p.corners[order[k]]), st[order[k]], shape, front, back, masks});
    for (const auto& uv : p.region ? p.region->pieces : std::vector<std::array<Vec2d, 4>>{})
      for (int k = 0; k < (uv[2] == uv[3] ? 3 : 6); ++k) {
        const Vec2d& at = uv[std::size_t(order[k])];
        vertices.push_back({to_local(position_at(p.corners, at.x, at.y)), Vec2f(at), shape, front, back, masks});
      }
    ++masks;
  }
  Quads quads;
  quads.vertices = int(vertices.size());
  quads.program = link_quad_program(masked, !scene.cuts.empty(), !lookup.region_cells().empty());
  glGenVertexArrays(1, &quads.array);
  glBindVertexArray(quads.array);
  upload(GL_ARRAY_BUFFER, vertices);
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), offset(offsetof(Vertex, position)));
  glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), offset(offsetof(Vertex, st)));
  glVertexAttribPointer(2, 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), offset(offsetof(Vertex, shape)));
  glVertexAttribIPointer(3, 3, GL_INT, sizeof(Vertex), offset(offsetof(Vertex, front)));
  glVertexAttribIPointer(4, 3, GL_INT, sizeof(Vertex), offset(offsetof(Vertex, back)));
  glVertexAttribIPointer(5, 1, GL_INT, sizeof(Vertex), offset(offsetof(Vertex, mask)));
  for (unsigned attribute = 0; attribute < (masked ? 6u : 5u); ++attribute) glEnableVertexAttribArray(attribute);
  return quads;
}

/// Uploads alpha mask records in the order of the masked quads.
void PatchIdRenderer::upload_masks(const PatchSet& scene) const {
  std::vector<std::uint32_t> texels;
  std::vector<std::int32_t> starts;
  std::size_t count = 0;
  for (const Texture& mask : scene.masks) {
    starts.push_back(std::int32_t(count));
    texels.resize((count + mask.texels.size() + 3) / 4, 0);
    for (const std::int32_t alpha : mask.texels) {
      texels[count / 4] |= std::uint32_t(alpha) << 8 * (count % 4);
      ++count;
    }
  }
  std::vector<AlphaMaskRecord> alpha_masks;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.mask < 0 || (p.back >= 0 && p.back < std::int32_t(i)) || is_not_drawn(scene, p)) continue;
    const Texture& mask = scene.masks[p.mask];
    const Texcoords& t = scene.texcoords.empty() ? kIdentityTexcoords : scene.texcoords[i];
    const CornerColors& c = scene.colors.empty() ? kWhiteVertices : scene.colors[i];
    const Material& material = scene.materials[p.material];
    alpha_masks.push_back({{t[0].x, t[0].y, t[1].x, t[1].y, t[2].x, t[2].y, t[3].x, t[3].y},
                           {c[0].w, c[1].w, c[2].w, c[3].w},
                           {starts[p.mask], mask.width, mask.height, mask.nearest},
                           {std::int32_t(mask.wrap[0]), std::int32_t(mask.wrap[1])},
                           {material.alpha, material.alpha_cutoff}});
  }
  upload_storage(3, alpha_masks);
  upload_storage(4, texels);
}

void PatchIdRenderer::upload_cuts(const PatchLookup& lookup) const {
  const auto number_of = [](std::int32_t side) { return side >= 0 ? side + 1 : side; };
  std::vector<CutLineRecord> lines;
  for (const CutLine& line : lookup.lines())
    lines.push_back({{line.constant, line.along_u, line.along_v, line.twist},
                     {number_of(line.sides[0]), number_of(line.sides[1])}});
  std::vector<std::int32_t> cut_of;
  for (const std::int32_t first : lookup.cut_of()) cut_of.push_back(first + 1);
  upload_storage(5, cut_of);
  upload_storage(6, lines);
}

void PatchIdRenderer::upload_spheres(const PatchSet& scene, const PatchLookup& lookup) {
  std::vector<SphereRecord> spheres;
  std::vector<std::array<std::int32_t, 2>> rings;
  sphere_of_.assign(scene.primitives.size(), -1);
  const auto add_rings = [&](std::int32_t i) {
    const auto first = std::int32_t(rings.size());
    const int count = i < 0 ? 0 : lookup.rows(i);
    for (int k = 0; k < count; ++k) rings.push_back({lookup.row(i, k).first, lookup.row(i, k).cells});
    return std::array{first, std::int32_t(count)};
  };
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.shape != Primitive::Shape::sphere || (p.back >= 0 && p.back < i) || is_not_drawn(scene, p)) continue;
    const bool outside = p.sphere_radius > 0;
    const auto outer = add_rings(outside ? i : p.back), inner = add_rings(outside ? p.back : i);
    sphere_of_[i] = std::int32_t(spheres.size());
    if (p.back >= 0) sphere_of_[p.back] = sphere_of_[i];
    const Vec3f center = to_local(p.sphere_center);
    spheres.push_back(
        {{center.x, center.y, center.z, float(std::abs(p.sphere_radius))}, {outer[0], outer[1], inner[0], inner[1]}});
  }
  spheres_ = int(spheres.size());
  glGenVertexArrays(1, &sphere_array_);
  upload_storage(1, spheres);
  upload_storage(2, rings);
}

void PatchIdRenderer::begin(int width, int height) {
  if (width != width_ || height != height_) {
    int largest = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    if (std::max(width, height) > largest)
      throw Error(ExitCode::over_limit, "the image is larger than the OpenGL driver's limit",
                  std::to_string(largest) + " pixels", "lower solve.hemicube_resolution or the preview's resolution");
    glDeleteRenderbuffers(1, &ids_);
    glDeleteRenderbuffers(1, &depth_);
    const auto attach = [&](unsigned& buffer, unsigned format, unsigned attachment) {
      glGenRenderbuffers(1, &buffer);
      glBindRenderbuffer(GL_RENDERBUFFER, buffer);
      glRenderbufferStorage(GL_RENDERBUFFER, format, width, height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
    };
    attach(ids_, GL_R32UI, GL_COLOR_ATTACHMENT0);
    attach(depth_, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT);
    width_ = width;
    height_ = height;
    pixels_.resize(std::size_t(width) * height);
  }
  const std::array<unsigned, 4> nothing{0, 0, 0, 0};
  glScissor(0, 0, width, height);
  glClearBufferuiv(GL_COLOR, 0, nothing.data());
  glClear(GL_DEPTH_BUFFER_BIT);
}

void PatchIdRenderer::draw(const GlView& view, int x, int y, int width, int height) {
  glViewport(x, y, width, height);
  glScissor(x, y, width, height);
  const Vec3f right = view.right / view.width;
  const std::array<float, 9> axes{right.x,        view.up.x, view.forward.x, right.y,       view.up.y,
                                  view.forward.y, right.z,   view.up.z,      view.forward.z};
  const float scale = 2.0f / (view.top - view.bottom);
  const auto set_view = [&](unsigned program) {
    glUseProgram(program);
    glUniform3f(glGetUniformLocation(program, "eye"), view.eye.x, view.eye.y, view.eye.z);
    glUniformMatrix3fv(glGetUniformLocation(program, "axes"), 1, GL_FALSE, axes.data());
    glUniform2f(glGetUniformLocation(program, "height"), scale, -1.0f - scale * view.bottom);
    glUniform1f(glGetUniformLocation(program, "near"), view.near);
  };
  for (const Quads& quads : {opaque_, masked_}) {
    if (quads.vertices == 0) continue;
    set_view(quads.program);
    glBindVertexArray(quads.array);
    glDrawArrays(GL_TRIANGLES, 0, quads.vertices);
  }
  if (spheres_ > 0) {
    set_view(sphere_program_);
    const std::int32_t self = view.self >= 0 ? sphere_of_[view.self] : -1;
    glUniform1i(glGetUniformLocation(sphere_program_, "self"), self);
    glUniform1i(glGetUniformLocation(sphere_program_, "self_inside"), view.self_inside);
    glBindVertexArray(sphere_array_);
    glEnable(GL_CULL_FACE);  // only back faces of the boxes: each pixel once, from inside too
    glCullFace(GL_FRONT);
    glDrawArraysInstanced(GL_TRIANGLES, 0, 36, spheres_);
    glDisable(GL_CULL_FACE);
  }
}

const std::vector<std::uint32_t>& PatchIdRenderer::read() {
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, GL_RED_INTEGER, GL_UNSIGNED_INT, pixels_.data());
  return pixels_;
}

}  // namespace patchlight
