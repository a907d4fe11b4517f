#include "pipeline/driver/cache/freshness.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <functional>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/formats/solution/transport_file.h"
#include "pipeline/frames/frame_layers.h"
#include "pipeline/image/image_file.h"
#include "pipeline/job/reader/job_changes.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;
using State = Freshness::State;

bool is_file(const fs::path& file) {
  std::error_code fault;
  return fs::is_regular_file(file, fault);
}

/// Calls `read`; an error marks the output as missing or damaged. Errors of the job itself are thrown on.
template <class Read>
Freshness try_reading(const fs::path& file, Read read) {
  if (std::error_code fault; !fs::exists(file, fault))
    return {State::missing, {file.filename().string() + " is missing"}, {}};
  try {
    read();
    return {};
  } catch (const Error& error) {
    if (error.code() != ExitCode::bad_data) throw;
    return {State::damaged, {error.what()}, {}};
  }
}

/// Source files at their present paths; the scene file is the first.
fs::path source_file(const Job& job, const std::vector<SourceFile>& sources, std::size_t i) {
  return i == 0 ? job.scene : job.scene.parent_path() / sources[i].path;
}

/// `what` with old and new value; keys are shortened to their first digits.
std::string change(const std::string& what, const std::string& old, const std::string& now) {
  const auto shortened = [](const std::string& key) { return key.empty() ? std::string("none") : key.substr(0, 8); };
  return what + " " + shortened(old) + " -> " + shortened(now);
}

using KeyOf = std::function<std::string(const Job&)>;

/// Compares the key of an output with the required key. `inputs`: changed inputs other than settings. If neither
/// settings nor inputs explain the difference, the reason is another version of the program.
void compare_keys(Freshness& state, const Job& job, const std::string& key, const std::string& made_for,
                  const KeyOf& key_of, const std::vector<std::string>& inputs) {
  if (key == state.key) return;
  state.state = State::stale;
  state.reasons = changed_settings(job, made_for, key_of);
  if (key != key_of(with_settings_of(job, made_for)))
    state.reasons.insert(state.reasons.end(), inputs.begin(), inputs.end());
  if (state.reasons.empty()) state.reasons.push_back("made by another version of Patchlight, or from something else");
}

/// Freshness of a frame's files. `key_of_frame` makes their key from the key of the traced frame.
Freshness picture_freshness(const Job& job, const PatchSet& scene, const Frame& frame, const std::string& view_config,
                            std::string (*key_of_frame)(const std::string&), const std::vector<ImageLayer>& layers) {
  const auto key_of = [&](const Job& other) {
    return key_of_frame(
        frame_key(scene, energy_key(scene.key, other.solve), other, frame.camera, frame.number, view_config));
  };
  Image header;
  Freshness state = try_reading(frame.exr, [&] { header = read_exr_header(frame.exr); });
  state.key = key_of(job);
  const auto refuse = [&](State fault, const std::string& reason) {
    state.state = fault;
    state.reasons = {reason};
    return state;
  };
  if (state.state == State::missing) return refuse(State::missing, "missing");
  if (!state.fresh()) return state;
  std::vector<std::string> inputs;
  for (const auto& [what, attribute, now] : {std::tuple("the patches", "patchlight:patches_key", scene.key),
                                             {"textures and shaders", "patchlight:frames_key", scene.frames_key},
                                             {"the camera", "patchlight:camera_key", camera_key(frame.camera)},
                                             {"the OpenColorIO files", "patchlight:view_config", view_config}})
    if (header.metadata[attribute] != now) inputs.push_back(change(what, header.metadata[attribute], now));
  compare_keys(state, job, header.metadata["patchlight:key"], header.metadata["patchlight:job"], key_of, inputs);
  if (!state.fresh()) return state;
  if (header.width != frame.size[0] || header.height != frame.size[1])
    return refuse(State::damaged, "it is of another size");
  if (const std::string layer = missing_layer(header, layers); !layer.empty())
    return refuse(State::damaged, "it lacks the layer `" + layer + "`");
  if (!is_file(frame.png)) return refuse(State::missing, "its PNG is missing");
  if (header.metadata["patchlight:png"] != hash_file(frame.png)) return refuse(State::damaged, "its PNG is damaged");
  const Freshness pixels = try_reading(frame.exr, [&] { read_exr(frame.exr); });
  return pixels.fresh() ? state : refuse(pixels.state, pixels.reasons.front());
}

std::string traced_key(const std::string& frame_key) {
  return frame_key;
}

}  // namespace

const char* Freshness::name() const {
  return std::array<const char*, 4>{"fresh", "stale", "missing", "damaged"}[std::size_t(state)];
}

std::string Freshness::reason(bool all) const {
  if (all || reasons.size() <= 1) return fmt::format("{}", fmt::join(reasons, "; "));
  return fmt::format("{}, and {} more (--explain lists them)", reasons.front(), reasons.size() - 1);
}

void JointFreshness::add(const std::string& name, const Freshness& one) {
  keys_.push_back(one.key);
  if (one.fresh()) return;
  const bool damaged = one.state == State::damaged || state_ == State::damaged;
  state_ = damaged ? State::damaged : State::stale;
  const std::string reason = fmt::format("{}", fmt::join(one.reasons, ", "));
  if (names_.empty() || names_.back().first != reason) names_.push_back({reason, {}});
  names_.back().second.push_back(name);
}

Freshness JointFreshness::all() const {
  KeyHasher key;
  for (const std::string& one : keys_) key.add(one);
  Freshness result{state_, {}, key.hex()};
  for (const auto& [reason, names] : names_)
    result.reasons.push_back(names.front() + (names.size() > 1 ? " to " + names.back() : "") + ": " + reason);
  return result;
}

std::string import_key(const Job& job, const std::vector<SourceFile>& sources) {
  std::vector<SourceFile> now = sources;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const fs::path file = source_file(job, sources, i);
    if (!is_file(file)) return "";
    now[i].hash = hash_file(file);
  }
  return import_inputs_key(now, job);
}

bool keeps_transport(const Job& job, const PatchSet& scene) {
  return job.solve.method == "matrix" && !scene.light_groups.empty();
}

Freshness transport_freshness(const Job& job, const PatchSet& scene) {
  std::string key;
  Freshness state = try_reading(job.transport_file(), [&] { key = read_transport_key(job.transport_file()); });
  state.key = transport_key(scene.geometry_key, job.solve);
  if (!state.fresh() || key == state.key) return state;
  return {State::stale, {change("transport.h5", key, state.key)}, state.key};
}

Freshness patches_freshness(const Job& job, PatchSet& scene) {
  Freshness state = try_reading(job.patch_file(), [&] { scene = read_patches(job.patch_file()); });
  if (!state.fresh()) return state;
  std::vector<SourceFile> sources = scene.sources;
  std::vector<std::string> changed;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const fs::path file = source_file(job, sources, i);
    if (!is_file(file)) return {State::stale, {file.string() + " is gone"}, {}};
    sources[i].hash = hash_file(file);
    if (sources[i].hash != scene.sources[i].hash)
      changed.push_back(change(file.filename().string(), scene.sources[i].hash, sources[i].hash));
  }
  const auto key_of = [&](const Job& other) { return import_inputs_key(sources, other); };
  state.key = key_of(job);
  state.warnings = scene.made.warnings;
  compare_keys(state, job, scene.inputs_key, scene.made.job, key_of, changed);
  return state;
}

Freshness energy_freshness(const Job& job, const PatchSet& scene) {
  EnergyField energy;
  const auto key_of = [&](const Job& other) { return energy_key(scene.key, other.solve); };
  Freshness state = try_reading(job.energy_file(), [&] { energy = read_energy(job.energy_file()); });
  state.key = key_of(job);
  if (!state.fresh()) return state;
  state.warnings = energy.made.warnings;
  std::vector<std::string> inputs;
  if (energy.patches_key != scene.key) inputs.push_back(change("the patches", energy.patches_key, scene.key));
  compare_keys(state, job, energy.key, energy.made.job, key_of, inputs);
  if (!state.fresh() || !keeps_transport(job, scene)) return state;
  const Freshness rows = transport_freshness(job, scene);
  state.state = rows.state;
  state.reasons = rows.reasons;
  return state;
}

Freshness frame_freshness(const Job& job, const PatchSet& scene, const Frame& frame, const std::string& view_config) {
  return picture_freshness(job, scene, frame, view_config, traced_key, frame_layers(job.trace, scene));
}

Freshness relit_freshness(const Job& job, const PatchSet& scene, const Frame& frame, const std::string& view_config) {
  return picture_freshness(job, scene, relit_frame(job, frame), view_config, relit_key, relit_layers(job.trace, scene));
}

}  // namespace patchlight
