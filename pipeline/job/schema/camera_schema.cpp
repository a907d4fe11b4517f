#include "pipeline/job/schema/camera_schema.h"

#include "pipeline/job/own_camera.h"
#include "pipeline/job/schema/value_parsing.h"

namespace patchlight {

using Node = YAML::Node;

void read_cameras(const Node& map, std::map<std::string, CameraConfig>& cameras) {
  const auto reader = [&](const std::string& name) -> EntryReader {
    CameraConfig& camera = cameras[name];
    return {{"look_from", [&](const Node& n) { camera.look_from = parse_vector(n); }},
            {"look_at", [&](const Node& n) { camera.look_at = parse_vector(n); }},
            {"up", [&](const Node& n) { camera.up = parse_vector(n); }},
            {"angle", [&](const Node& n) { camera.angle = parse_number(n, 0.01, 179); }},
            {"height", [&](const Node& n) { camera.height = parse_number(n, 1e-9, 1e9); }},
            {"turntable", [&](const Node& n) { camera.turntable = parse_number(n, -1e7, 1e7); }}};
  };
  read_entries("cameras", map, reader, [&](const std::string& name) {
    const CameraConfig& camera = cameras.at(name);
    if (name.empty()) throw std::string("give the camera a name");
    if (camera.angle && camera.height) throw std::string("give `angle`, or `height` for a parallel projection");
    if (!own_camera(name, camera, 1))
      throw std::string("give `look_from` and `look_at` apart from each other, and `up` across the way between them");
  });
}

Node cameras_node(const std::map<std::string, CameraConfig>& cameras) {
  Node map(YAML::NodeType::Map);
  for (const auto& [name, camera] : cameras) {
    Node node(YAML::NodeType::Map);
    node["look_from"] = vector_node(camera.look_from);
    node["look_at"] = vector_node(camera.look_at);
    node["up"] = vector_node(camera.up);
    if (camera.angle) node["angle"] = *camera.angle;
    if (camera.height) node["height"] = *camera.height;
    node["turntable"] = camera.turntable;
    map[name] = node;
  }
  return map;
}

}  // namespace patchlight
