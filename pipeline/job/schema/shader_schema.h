#pragma once
#include <yaml-cpp/yaml.h>

#include <vector>

#include "pipeline/model/shader.h"

namespace patchlight {

/// Reads the job's `shaders`; their expressions are not compiled here.
/// Throws: std::string, the fault and the allowed values.
void read_shaders(const YAML::Node& map, std::vector<Shader>& shaders);

YAML::Node shaders_node(const std::vector<Shader>& shaders);

}  // namespace patchlight
