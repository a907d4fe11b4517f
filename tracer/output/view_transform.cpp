#include "tracer/output/view_transform.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "pipeline/model/error.h"
#include "tracer/output/shipped_config.h"

namespace ocio = OCIO_NAMESPACE;

namespace patchlight {

namespace {

ocio::ConstConfigRcPtr load_config(std::string& name) {
  const char* file = std::getenv("OCIO");
  if (!file || !*file) {
    name = "the shipped config.ocio";
    std::istringstream text(kShippedOcioConfig);
    return ocio::Config::CreateFromStream(text);
  }
  name = file;
  if (std::error_code fault; !std::filesystem::is_regular_file(file, fault))
    throw Error(ExitCode::missing_input, "missing OpenColorIO config", name, "set or unset $OCIO");
  return ocio::Config::CreateFromFile(file);
}

float displayable(float x) {
  constexpr float kLargestHalf = 65504.0f;
  return x > 0 ? std::min(x, kLargestHalf) : 0.0f;  // NaN is not greater than zero
}

}  // namespace

struct ViewTransform::Processor {
  ocio::ConstCPUProcessorRcPtr cpu;
};

ViewTransform::ViewTransform(const std::string& view, double exposure)
    : processor_(std::make_unique<Processor>()), gain_(float(std::exp2(exposure))) {
  std::string name;
  try {
    const ocio::ConstConfigRcPtr config = load_config(name);
    const char* display = config->getDefaultDisplay();
    std::vector<std::string> views;
    for (int i = 0; i < config->getNumViews(display); ++i) views.emplace_back(config->getView(display, i));
    if (std::find(views.begin(), views.end(), view) == views.end())
      throw Error(ExitCode::bad_config, "unknown view `" + view + "`", "trace.view",
                  fmt::format("{} has: {}", name, fmt::join(views, ", ")));
    processor_->cpu = config->getProcessor(ocio::ROLE_SCENE_LINEAR, display, view.c_str(), ocio::TRANSFORM_DIR_FORWARD)
                          ->getDefaultCPUProcessor();
  } catch (const ocio::Exception& error) {
    throw Error(ExitCode::bad_data, std::string("bad OpenColorIO config: ") + error.what(), name,
                "mend it or unset $OCIO");
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
