#include "pipeline/job/schema/job_schema.h"
#include "pipeline/job/schema/key_kinds.h"
#include "pipeline/job/schema/value_parsing.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

JobKey color_key(std::optional<Color>& color) {
  return {"environment.color", "radiance of light from all around, [r,g,b] in W/m2/sr; or what multiplies its image",
          [&color](const Node& n) { color = parse_color(n, 1e30); },
          [&color] { return color ? vector_node(*color) : Node(); }};
}

}  // namespace

std::vector<JobKey> environment_keys(EnvironmentConfig& sky) {
  return {
      color_key(sky.color),
      path_key("environment.image", sky.image, "the same as an equirectangular image, .hdr or .exr"),
      number_key("environment.strength", sky.strength, 0, 1e30, "what multiplies it"),
      number_key("environment.rotation", sky.rotation, -360, 360,
                 "degrees by which the image turns about the vertical axis, counter-clockwise from above"),
      {"environment.light_group", "the name of its light group",
       [&sky](const Node& n) { sky.light_group = parse_group(n); }, [&sky] { return Node(sky.light_group); }},
  };
}

}  // namespace patchlight
