#pragma once
#include <yaml-cpp/yaml.h>

#include <map>
#include <string>

#include "pipeline/job/job.h"

namespace patchlight {

/// Reads the section `cameras` and adds or changes cameras. Throws: std::string; EntryFault.
void read_cameras(const YAML::Node& map, std::map<std::string, CameraConfig>& cameras);

YAML::Node cameras_node(const std::map<std::string, CameraConfig>& cameras);

}  // namespace patchlight
