#include "tracer/output/view_transform.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "pipeline/job/view_config.h"
#include "pipeline/model/error.h"
#include "tracer/output/shipped_config.h"

namespace ocio = OCIO_NAMESPACE;

namespace patchlight {

namespace {

ocio::ConstConfigRcPtr load_config(const std::filesystem::path& file) {
  if (!file.empty()) return ocio::Config::CreateFromFile(file.c_str());
  std::istringstream text(kShippedOcioConfig);
  return ocio::Config::CreateFromStream(text);
}

/// Throws: Error (bad_config) unless the job's name is one of the config's.
void check_name(const std::string& name, const std::vector<std::string>& known, const char* fault, const char* key,
                const std::string& config) {
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw Error(ExitCode::bad_config, fmt::format("{} `{}`", fault, name), key,
                fmt::format("{} has: {}", config, known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
}

/// From scene-linear radiance to display values, as Blender does: look, view, gamma.
ocio::ConstTransformRcPtr transform_of(const PictureConfig& picture, const char* display) {
  const ocio::GroupTransformRcPtr group = ocio::GroupTransform::Create();
  if (!picture.look.empty()) {
    const ocio::LookTransformRcPtr look = ocio::LookTransform::Create();
    look->setSrc(ocio::ROLE_SCENE_LINEAR);
    look->setDst(ocio::ROLE_SCENE_LINEAR);
    look->setLooks(picture.look.c_str());
    group->appendTransform(look);
  }
  const ocio::DisplayViewTransformRcPtr view = ocio::DisplayViewTransform::Create();
  view->setSrc(ocio::ROLE_SCENE_LINEAR);
  view->setDisplay(display);
  view->setView(picture.view.c_str());
  view->setLooksBypass(!picture.look.empty());
  group->appendTransform(view);
  if (picture.gamma != 1.0) {
    const ocio::ExponentTransformRcPtr exponent = ocio::ExponentTransform::Create();
    const double power = 1.0 / picture.gamma;
    exponent->setValue({power, power, power, 1.0});
    group->appendTransform(exponent);
  }
  return group;
}

float displayable(float x) {
  constexpr float kLargestHalf = 65504.0f;
  return x > 0 ? std::min(x, kLargestHalf) : 0.0f;  // NaN is not greater than zero
}

}  // namespace

struct ViewTransform::Processor {
  ocio::ConstCPUProcessorRcPtr cpu;
};

ViewTransform::ViewTransform(const PictureConfig& picture)
    : processor_(std::make_unique<Processor>()), gain_(float(std::exp2(picture.exposure))) {
  const std::filesystem::path file = view_config_file(picture.ocio);
  const std::string name = file.empty() ? "the shipped config.ocio" : file.string();
  try {
    const ocio::ConstConfigRcPtr config = load_config(file);
    const char* display = config->getDefaultDisplay();
    std::vector<std::string> views, looks;
    for (int i = 0; i < config->getNumViews(display); ++i) views.emplace_back(config->getView(display, i));
    for (int i = 0; i < config->getNumLooks(); ++i) looks.emplace_back(config->getLookNameByIndex(i));
    check_name(picture.view, views, "unknown view", "trace.view", name);
    if (!picture.look.empty()) check_name(picture.look, looks, "unknown look", "trace.look", name);
    processor_->cpu = config->getProcessor(transform_of(picture, display))->getDefaultCPUProcessor();
  } catch (const ocio::Exception& error) {
    throw Error(ExitCode::bad_data, std::string("bad OpenColorIO config: ") + error.what(), name,
                "mend it, or choose another with `trace.ocio` or $OCIO");
  }
}

ViewTransform::~ViewTransform() = default;

Image ViewTransform::operator()(const Image& linear) const {
  Image result = linear;
  for (Color& pixel : result.pixels)
    for (int k = 0; k < 3; ++k) pixel[k] = displayable(pixel[k] * gain_);
  ocio::PackedImageDesc pixels(result.pixels.data(), result.width, result.height, 3);
  processor_->cpu->apply(pixels);
  for (Color& pixel : result.pixels)
    for (int k = 0; k < 3; ++k) pixel[k] = std::min(displayable(pixel[k]), 1.0f);
  return result;
}

}  // namespace patchlight
