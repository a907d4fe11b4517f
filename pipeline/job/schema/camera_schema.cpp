#include "pipeline/job/schema/camera_schema.h"

#include <utility>

#include "pipeline/job/own_camera.h"
#include "pipeline/job/schema/value_parsing.h"

namespace patchlight {

using Node = YAML::Node;

namespace {

Vec2d parse_shift(const Node& node) {
  if (!node.IsSequence() || node.size() != 2) throw std::string("expected two numbers [x, y]");
  return {parse_number(node[0], -kMaxShift, kMaxShift), parse_number(node[1], -kMaxShift, kMaxShift)};
}

}  // namespace

void read_cameras(const Node& map, std::map<std::string, CameraConfig>& cameras) {
  const auto reader = [&](const std::string& name) -> EntryReader {
    CameraConfig& camera = cameras[name];
    return {{"look_from", [&](const Node& n) { camera.look_from = parse_vector(n); }},
            {"look_at", [&](const Node& n) { camera.look_at = parse_vector(n); }},
            {"up", [&](const Node& n) { camera.up = parse_vector(n); }},
            {"angle", [&](const Node& n) { camera.angle = parse_number(n, 0.01, 179); }},
            {"height", [&](const Node& n) { camera.height = parse_number(n, 1e-9, 1e9); }},
            {"turntable", [&](const Node& n) { camera.turntable = parse_number(n, -1e7, 1e7); }},
            {"shift", [&](const Node& n) { camera.shift = parse_shift(n); }},
            {"aspect", [&](const Node& n) { camera.aspect = parse_number(n, kMinAspect, kMaxAspect); }},
            {"znear", [&](const Node& n) { camera.znear = parse_number(n, 0, kMaxDepth); }},
            {"zfar", [&](const Node& n) { camera.zfar = parse_number(n, kMinDepth, kMaxDepth); }},
            {"aperture", [&](const Node& n) { camera.aperture = parse_number(n, 0, kMaxAperture); }},
            {"focus", [&](const Node& n) { camera.focus = parse_number(n, kMinDepth, kMaxDepth); }}};
  };
  read_entries("cameras", map, reader, [&](const std::string& name) {
    const CameraConfig& camera = cameras.at(name);
    if (name.empty()) throw std::string("give the camera a name");
    if (camera.angle && camera.height) throw std::string("give `angle`, or `height` for a parallel projection");
    if (camera.znear && camera.zfar && *camera.znear >= *camera.zfar) throw std::string("give a `zfar` above `znear`");
    if (!camera.has_pose() && (camera.up || camera.turntable != 0))
      throw std::string("give `look_from` and `look_at` too; without them the scene's camera keeps its place");
    if (camera.has_pose() && !own_camera(name, camera, 1))
      throw std::string("give `look_from` and `look_at` apart from each other, and `up` across the way between them");
  });
}

Node cameras_node(const std::map<std::string, CameraConfig>& cameras) {
  Node map(YAML::NodeType::Map);
  for (const auto& [name, camera] : cameras) {
    Node node(YAML::NodeType::Map);
    for (const auto& [key, vector] :
         {std::pair("look_from", camera.look_from), {"look_at", camera.look_at}, {"up", camera.up}})
      if (vector) node[key] = vector_node(*vector);
    if (camera.turntable != 0) node["turntable"] = camera.turntable;
    if (camera.shift) node["shift"] = vector_node(*camera.shift, 2);
    for (const auto& [key, number] : {std::pair("angle", camera.angle),
                                      {"height", camera.height},
                                      {"aspect", camera.aspect},
                                      {"znear", camera.znear},
                                      {"zfar", camera.zfar},
                                      {"aperture", camera.aperture},
                                      {"focus", camera.focus}})
      if (number) node[key] = number_node(*number);
    map[name] = node;
  }
  return map;
}

}  // namespace patchlight
