#include "solver/preview/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/frames/frame_list.h"
#include "pipeline/frames/light_settings.h"
#include "pipeline/model/error.h"
#include "pipeline/optics/sampling/random.h"
#include "solver/form_factors/row_scattering.h"
#include "solver/hemicube/hemicube.h"
#include "solver/preview/false_color.h"

namespace patchlight {

namespace {

constexpr int kSupersampling = 2;  // along each axis
const Color kHighlight(1.0f, 0.15f, 0.1f);

/// A pseudo-random colour of a patch.
Color patch_color(std::uint32_t i) {
  const std::uint64_t x = hash64(i);
  const float hue = 6 * uniform01(x), value = 0.55f + 0.4f * uniform01(x << 24);
  const auto channel = [&](float shift) {
    const float k = std::fmod(shift + hue, 6.0f);
    return value * (1.0f - 0.45f * std::clamp(std::min(k, 4.0f - k), 0.0f, 1.0f));
  };
  return {channel(5), channel(3), channel(1)};
}

float encode_srgb(float x) {
  x = std::clamp(x, 0.0f, 1.0f);
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

GlView camera_view(const Camera& camera, const PatchIdRenderer& renderer, const PatchSet& scene, int width,
                   int height) {
  if (camera.projection != Camera::Projection::perspective)
    throw Error(ExitCode::bad_config, "previews need a perspective camera", camera.name,
                "choose another with --camera");
  const auto axis = [&](const Vec3d& local) {
    Vec3d world;
    camera.to_world.multDirMatrix(local, world);
    return Vec3f(world.normalized());
  };
  GlView view;
  view.eye = renderer.to_local(camera.to_world.translation());
  view.right = axis({1, 0, 0});
  view.up = axis({0, 1, 0});
  view.forward = axis({0, 0, -1});
  const auto half_height = float(std::tan(camera.vertical / 2));
  view.top = half_height * float(1 + 2 * camera.shift.y);
  view.bottom = half_height * float(-1 + 2 * camera.shift.y);
  view.width = half_height * float(width) / float(height);
  view.right -= view.forward * (view.width * float(2 * camera.shift.x));  // shears the view
  view.near = std::max(float(camera.znear), 1e-2f * float(std::sqrt(scene.patches[0].area)));
  return view;
}

/// Averages blocks of pixels and flips rows, since OpenGL's start at the bottom.
Image shrink(const std::vector<Color>& pixels, int width, int height, int factor) {
  Image image{width / factor, height / factor, {}, {}};
  for (int y = image.height - 1; y >= 0; --y)
    for (int x = 0; x < image.width; ++x) {
      Color sum(0.0f);
      for (int k = 0; k < factor * factor; ++k)
        sum += pixels[std::size_t(y * factor + k / factor) * width + x * factor + k % factor];
      image.pixels.push_back(sum / float(factor * factor));
    }
  return image;
}

/// Ids as colours, with dark lines between patches if `edges`.
template <class ColorOf>
std::vector<Color> paint(const std::vector<std::uint32_t>& ids, int width, bool edges, ColorOf color_of) {
  std::vector<Color> pixels;
  pixels.reserve(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::uint32_t id = ids[i];
    Color color = id == 0 ? Color(0.02f) : color_of(id - 1);
    const std::size_t below = i >= std::size_t(width) ? i - width : i, left = i % std::size_t(width) ? i - 1 : i;
    if (edges && (ids[below] != id || ids[left] != id)) color *= 0.35f;
    pixels.push_back(color);
  }
  return pixels;
}

/// Arranges the five faces as a cross: the top in the middle, each side attached to it at its upper edge.
Image unfold(const Image& faces, int n) {
  Image cross{2 * n, 2 * n, std::vector<Color>(std::size_t(4) * n * n, Color(0.0f)), {}};
  const auto from = [&](int row, int i, int j) -> const Color& {  // rows count from the bottom
    return faces.pixels[std::size_t(3 * n - 1 - (row + j)) * n + i];
  };
  const auto to = [&](int x, int y) -> Color& { return cross.pixels[std::size_t(2 * n - 1 - y) * 2 * n + x]; };
  const int h = n / 2;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) to(h + i, h + j) = from(0, i, j);
  for (int j = 0; j < h; ++j)
    for (int i = 0; i < n; ++i) {
      to(h + n + h - 1 - j, h + n - 1 - i) = from(n, i, j);        // towards the top's right
      to(h + n - 1 - i, h - 1 - (h - 1 - j)) = from(n + h, i, j);  // towards its lower edge
      to(j, h + i) = from(2 * n, i, j);                            // towards its left
      to(h + i, h + n + h - 1 - j) = from(2 * n + h, i, j);        // towards its upper edge
    }
  return cross;
}

Image draw_hemicube(const Job& job, const PatchSet& scene, std::int64_t index, PatchIdRenderer& renderer) {
  const Patch& patch = scene.patches[std::size_t(index)];
  const Primitive& primitive = scene.primitives[patch.primitive];
  const int n = job.solve.hemicube_resolution;
  renderer.begin(n, 3 * n);
  for (HemicubeFace& face :
       hemicube_faces(renderer.to_local(patch.center), patch.normal, 0.0f, float(std::sqrt(patch.area)), n)) {
    face.view.self = patch.primitive;
    face.view.self_inside = primitive.sphere_radius < 0;
    renderer.draw(face.view, 0, face.row, n, face.rows);
  }
  return unfold(shrink(paint(renderer.read(), n, false, patch_color), n, 3 * n, 1), n);
}

}  // namespace

Image draw_preview(const Job& job, const PatchSet& scene, const PreviewOptions& options) {
  if (options.patch && (*options.patch < 0 || *options.patch >= std::int64_t(scene.patches.size())))
    throw Error(ExitCode::bad_config, fmt::format("no patch {}", *options.patch), "--patch",
                fmt::format("the scene has patches 0 to {}", scene.patches.size() - 1));
  PatchIdRenderer renderer(scene);
  if (options.kind == "hemicube") return draw_hemicube(job, scene, options.patch.value_or(0), renderer);

  Job choice = job;
  if (!options.camera.empty()) choice.trace.cameras = {options.camera};
  const Frame frame = job_frames(choice, scene)[0];
  const Camera& camera = frame.camera;
  const int width = frame.size[0] * kSupersampling, height = frame.size[1] * kSupersampling;
  renderer.begin(width, height);
  renderer.draw(camera_view(camera, renderer, scene, width, height), 0, 0, width, height);
  const std::vector<std::uint32_t>& ids = renderer.read();
  const auto downsample = [&](const std::vector<Color>& pixels) {
    return shrink(pixels, width, height, kSupersampling);
  };

  if (options.kind == "patches")
    return downsample(paint(ids, width, true, [&](std::uint32_t i) {
      return options.patch && std::int64_t(i) == *options.patch ? kHighlight : patch_color(i);
    }));
  const std::vector<Color> received =
      irradiance(read_energy(job.energy_file(), scene), light_settings(job, scene, 1), scene.patches.size());
  if (options.kind == "radiosity") {
    const float gain = float(std::exp2(job.trace.picture.exposure) / kPi);
    const SpectrumField scattered =
        row_scattering(scene, false).exitance(SpectrumField(received.begin(), received.end()));
    return downsample(paint(ids, width, false, [&](std::uint32_t i) {
      const Spectrum& s = scattered[i];
      const Color radiance =
          (scene.patches[i].emission + Color(Vec3f(float(s.c[0]), float(s.c[1]), float(s.c[2])))) * gain;
      return Color(encode_srgb(radiance.x), encode_srgb(radiance.y), encode_srgb(radiance.z));
    }));
  }
  std::vector<float> sums;
  for (const Color& h : received) sums.push_back(h.x + h.y + h.z);
  std::vector<float> sorted = sums;
  const auto high = sorted.begin() + std::ptrdiff_t(double(sorted.size() - 1) * 0.995);
  std::nth_element(sorted.begin(), high, sorted.end());
  const float largest = std::max(*high, 1e-30f);
  Image image = downsample(paint(ids, width, false, [&](std::uint32_t i) { return false_color(sums[i] / largest); }));
  draw_scale(image, largest, "W/m2");
  return image;
}

}  // namespace patchlight
