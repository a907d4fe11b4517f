#include <array>
#include <regex>

#include "pipeline/job/schema/job_schema.h"
#include "pipeline/job/schema/key_kinds.h"
#include "pipeline/job/schema/value_parsing.h"
#include "pipeline/model/shard.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

JobKey text_key(const std::string& path, std::string& value, const char* good, const std::string& expected,
                const std::string& help) {
  return {path, help,
          [&value, good, expected](const Node& n) {
            const std::string read = parse<std::string>(n, expected);
            if (!std::regex_match(read, std::regex(good))) throw "expected " + expected;
            value = read;
          },
          [&value] { return Node(value); }};
}

/// Long options that do not undo what the driver itself tells sbatch.
void read_options(const Node& node, std::vector<std::string>& options) {
  static const std::regex option("--([a-z][a-z0-9-]*)(=[^\\x00-\\x1f]*)?");
  static constexpr std::array<const char*, 15> kOwn{"requeue", "no-requeue", "array",     "chdir", "dependency",
                                                    "error",   "input",      "job-name",  "help",  "output",
                                                    "export",  "parsable",   "test-only", "wait",  "wrap"};
  const std::string expected = "a list of long options of sbatch, such as [--mem=8G, --qos=high]";
  options.clear();
  for (const std::string& text : parse<std::vector<std::string>>(node, expected)) {
    std::smatch parts;
    if (!std::regex_match(text, parts, option)) throw "expected " + expected;
    for (const char* own : kOwn)
      if (parts[1] == own) throw "expected other options than --" + std::string(own) + ", which Patchlight sets itself";
    options.push_back(text);
  }
}

}  // namespace

std::vector<JobKey> slurm_keys(SlurmConfig& slurm) {
  static constexpr const char* kName = "[^\\x00-\\x20-][^\\x00-\\x20]*";
  static constexpr const char* kTime = "[0-9]+|([0-9]+:)?[0-9]+:[0-9]{2}|[0-9]+-[0-9]+(:[0-9]{2}){0,2}";
  return {
      integer_key("slurm.shards", slurm.shards, 1, kMostShards,
                  "tasks that rows of form factors are shared by, and frames; 1: not shared"),
      integer_key("slurm.cpus", slurm.cpus, 1, 4096, "of a task, unless --threads says how many"),
      text_key("slurm.partition", slurm.partition, kName, "the name of a partition, or several with commas",
               "where tasks run; absent: as Slurm has it"),
      text_key("slurm.time", slurm.time, kTime, "a time as sbatch takes it: minutes, 1:30:00 or 2-12",
               "most that a task may take; absent: as Slurm has it"),
      {"slurm.options", "more for sbatch, as [--mem=8G]", [&slurm](const Node& n) { read_options(n, slurm.options); },
       [&slurm] { return Node(slurm.options); }},
      integer_key("slurm.retries", slurm.retries, 0, 100, "how often a task that is lost or killed is done again"),
  };
}

}  // namespace patchlight
