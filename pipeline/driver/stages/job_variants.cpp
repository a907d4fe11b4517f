#include "pipeline/driver/stages/job_variants.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <cctype>
#include <set>

#include "pipeline/driver/cache/output_cache.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

constexpr std::size_t kLongestName = 200;

std::string folder_name(const std::string& name, std::set<std::string>& taken) {
  // Names that would collide with folders of the job.
  if (taken.empty()) taken = {"frames", "relit", "cache", "preview", "bench", "slurm", "blend", ".", ".."};
  std::string plain = name.substr(0, kLongestName);
  for (char& c : plain)
    if (!std::isalnum(static_cast<unsigned char>(c)) && std::string("._-=,+").find(c) == std::string::npos) c = '_';
  std::string result = plain;
  for (int copy = 2; !taken.insert(result).second; ++copy) result = fmt::format("{}_{}", plain, copy);
  return result;
}

}  // namespace

std::vector<JobVariant> job_variants(const std::string& job_file, const CommonOptions& options,
                                     const std::string& pattern) {
  const auto job_template = std::make_shared<JobTemplate>(job_file);
  const Job job = job_template->job(options.sets, options.output);
  job_template->drop_matrix();  // each variant would copy it
  const std::string cache = cache_folder(job).string();
  if (job.matrix.empty() && pattern.empty()) return {{job_file, "", options, cache, job_template}};
  std::vector<JobVariant> variants;
  std::vector<std::string> names;
  std::set<std::string> taken;
  std::vector<std::size_t> at(job.matrix.size(), 0);
  for (bool more = !job.matrix.empty(); more;) {
    JobVariant variant{job_file, "", options, cache, job_template};
    variant.options.sets.clear();
    for (std::size_t k = 0; k < at.size(); ++k) {
      const MatrixAxis::Choice& choice = job.matrix[k].choices[at[k]];
      variant.name += (k > 0 ? "," : "") + choice.name;
      for (const auto& [key, value] : choice.settings) variant.options.sets.push_back(key + "=" + value);
    }
    variant.options.sets.insert(variant.options.sets.end(), options.sets.begin(), options.sets.end());
    variant.options.output = (job.output / folder_name(variant.name, taken)).string();
    names.push_back(variant.name);
    if (pattern.empty() || fnmatch(pattern.c_str(), variant.name.c_str(), 0) == 0)
      variants.push_back(std::move(variant));
    more = false;
    for (std::size_t k = at.size(); k-- > 0 && !more;) {
      more = ++at[k] < job.matrix[k].choices.size();
      if (!more) at[k] = 0;
    }
  }
  if (variants.empty())
    throw Error(ExitCode::bad_config, "no variant is named `" + pattern + "`", job_file + ", matrix",
                names.empty() ? "it has no matrix" : fmt::format("it has: {}", fmt::join(names, " ")));
  return variants;
}

}  // namespace patchlight
