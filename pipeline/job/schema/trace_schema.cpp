#include <fmt/format.h>

#include <array>
#include <set>

#include "pipeline/job/frame_range.h"
#include "pipeline/job/schema/key_kinds.h"
#include "pipeline/job/schema/value_parsing.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

JobKey cameras_key(std::vector<std::string>& cameras) {
  return {"trace.cameras", "names of cameras, those of glTF nodes or of the job's `cameras`; absent: all",
          [&cameras](const Node& n) {
            if (n.IsScalar())
              cameras = {n.as<std::string>()};
            else
              cameras = parse<std::vector<std::string>>(n, "a list of camera names");
          },
          [&cameras] { return Node(cameras); }};
}

JobKey frames_key(std::string& frames) {
  return {
      "trace.frames",
      "frames of cameras that move: 1-120; 1,5..9; with a step 1-120x10 or 1..120:10; a still one writes frame 0001",
      [&frames](const Node& n) {
        const std::string expected = "frames such as 1-120 or 1,5..9,20-40x2";
        std::string list;
        if (n.IsSequence())
          list = fmt::format("{}", fmt::join(parse<std::vector<std::string>>(n, expected), ", "));
        else
          list = parse<std::string>(n, expected);
        frame_numbers(list);
        frames = list;
      },
      [&frames] { return Node(frames); }};
}

JobKey resolution_key(std::optional<std::array<int, 2>>& size) {
  return {"trace.resolution",
          "width and height of frames in pixels; absent: as many pixels as 640 x 480 in the camera's shape",
          [&size](const Node& n) {
            if (!n.IsSequence() || n.size() != 2) throw std::string("expected [width, height]");
            size = {int(parse_integer(n[0], 1, 65536)), int(parse_integer(n[1], 1, 65536))};
          },
          [&size] { return size ? vector_node(*size, 2) : Node(); }};
}

JobKey layers_key(std::vector<std::string>& layers) {
  const std::vector<std::string> known{"direct",       "indirect", "specular",    "metal",  "coat",
                                       "transmission", "emission", "albedo",      "normal", "depth",
                                       "position",     "patch",    "light_groups"};
  return {"trace.layers", fmt::format("additional layers of the EXR: {}", fmt::join(known, ", ")),
          [&layers, known](const Node& n) {
            if (n.IsMap()) throw std::string("expected a list of layers");
            std::set<std::string> chosen;
            if (n.IsScalar()) chosen.insert(parse_choice(n, known));
            for (const Node& name : n) chosen.insert(parse_choice(name, known));
            layers.clear();
            for (const std::string& name : known)  // in canonical order
              if (chosen.contains(name)) layers.push_back(name);
          },
          [&layers] { return Node(layers); }};
}

JobKey name_key(const char* path, std::string& name, const char* what, const char* help) {
  return {path, help,
          [&name, what](const Node& n) { name = parse<std::string>(n, std::string("the name of ") + what); },
          [&name] { return Node(name); }};
}

}  // namespace

std::vector<JobKey> trace_keys(TraceConfig& trace) {
  return {
      cameras_key(trace.cameras),
      frames_key(trace.frames),
      number_key("trace.fps", trace.fps, 1e-3, 1e6, "frames a second of animated cameras"),
      resolution_key(trace.resolution),
      choice_key("trace.quality", trace.quality, {"patches", "direct", "gather"},
                 "all light interpolated; direct light at the pixel; or all light gathered at the pixel, as a check"),
      integer_key("trace.gather_rays", trace.gather_rays, 1, 4096, "rays per sample of quality `gather`"),
      integer_key(
          "trace.samples", trace.samples, 1, 1 << 16,
          "samples per pixel where colours vary; 4 times as many at edges, a quarter (at least 4) in smooth regions"),
      flag_key("trace.cull_backfaces", trace.cull_backfaces, "look through the backs of single-sided surfaces"),
      layers_key(trace.layers),
      choice_key("trace.pixel_type", trace.pixel_type, {"half", "float"},
                 "type of light and colour channels in the EXR"),
      choice_key("trace.compression", trace.compression, {kExrCompressions.begin(), kExrCompressions.end()},
                 "compression of the EXR"),
      path_key("trace.ocio", trace.picture.ocio,
               "OpenColorIO config of the PNG; absent: that of $OCIO, or the shipped one"),
      name_key("trace.view", trace.picture.view, "a view",
               "OpenColorIO view of the PNG: sRGB, ACES or Raw of the shipped config, or one of another config"),
      name_key("trace.look", trace.picture.look, "a look", "look of the OpenColorIO config for the PNG"),
      number_key("trace.exposure", trace.picture.exposure, -100, 100, "exposure of the PNG in stops"),
      number_key("trace.gamma", trace.picture.gamma, 0.01, 100, "display values of the PNG are raised to its inverse"),
  };
}

}  // namespace patchlight
