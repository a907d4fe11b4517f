#include "pipeline/job/schema/job_schema.h"
#include "pipeline/job/schema/key_kinds.h"
#include "pipeline/job/schema/value_parsing.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

JobKey color_key(std::optional<Color>& color) {
  return {"environment.color", "radiance of the environment, [r,g,b] in W/m2/sr; with an image, its factor",
          [&color](const Node& n) { color = parse_color(n, 1e30); },
          [&color] { return color ? vector_node(*color) : Node(); }};
}

}  // namespace

std::vector<JobKey> environment_keys(EnvironmentConfig& sky) {
  return {
      color_key(sky.color),
      path_key("environment.image", sky.image, "radiance of the environment as an equirectangular image, .hdr or .exr"),
      number_key("environment.strength", sky.strength, 0, 1e30, "factor of the radiance"),
      number_key("environment.rotation", sky.rotation, -360, 360,
                 "rotation of the image about the vertical axis in degrees, counter-clockwise from above"),
      {"environment.light_group", "name of its light group",
       [&sky](const Node& n) { sky.light_group = parse_group(n); }, [&sky] { return Node(sky.light_group); }},
  };
}

}  // namespace patchlight
