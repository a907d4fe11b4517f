#include <algorithm>
#include <array>

#include "pipeline/job/schema/job_schema.h"
#include "pipeline/job/schema/key_kinds.h"
#include "pipeline/job/schema/value_parsing.h"
#include "pipeline/job/shard.h"
#include "pipeline/system/text_scanner.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

/// Names of partitions: one word that is no option.
bool is_partition(const std::string& text) {
  return !text.empty() && text[0] != '-' &&
         std::none_of(text.begin(), text.end(), [](unsigned char c) { return c <= ' '; });
}

/// MINUTES, [H:]M:SS, or DAYS-H with up to two more parts of two digits.
bool is_time_limit(const std::string& limit) {
  TextScanner text(limit);
  if (text.take_digits().empty()) return false;
  if (text.done()) return true;
  if (text.skip("-")) {
    if (text.take_digits().empty()) return false;
    for (int part = 0; part < 2 && text.skip(":"); ++part)
      if (text.take_digits().size() != 2) return false;
    return text.done();
  }
  if (!text.skip(":")) return false;
  std::string_view last = text.take_digits();
  if (!last.empty() && text.skip(":")) last = text.take_digits();
  return last.size() == 2 && text.done();
}

JobKey text_key(const std::string& path, std::string& value, bool (*is_good)(const std::string&),
                const std::string& expected, const std::string& help) {
  return {path, help,
          [&value, is_good, expected](const Node& n) {
            const std::string read = parse<std::string>(n, expected);
            if (!is_good(read)) throw "expected " + expected;
            value = read;
          },
          [&value] { return Node(value); }};
}

/// The name in `--name` or `--name=value`; empty: `option` is neither.
std::string_view long_option_name(const std::string& option) {
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_of_name = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '-'; };
  TextScanner text(option);
  if (!text.skip("--") || text.done() || !is_letter(text.rest()[0])) return {};
  const std::string_view name = text.take(is_of_name);
  if (text.skip("=")) text.take([](unsigned char c) { return c >= ' '; });
  return text.done() ? name : std::string_view();
}

/// Checks that options are long ones that do not conflict with those the driver passes to sbatch.
void read_options(const Node& node, std::vector<std::string>& options) {
  static constexpr std::array<const char*, 15> kOwn{"requeue", "no-requeue", "array",     "chdir", "dependency",
                                                    "error",   "input",      "job-name",  "help",  "output",
                                                    "export",  "parsable",   "test-only", "wait",  "wrap"};
  const std::string expected = "a list of long options of sbatch, such as [--mem=8G, --qos=high]";
  options.clear();
  for (const std::string& text : parse<std::vector<std::string>>(node, expected)) {
    const std::string_view name = long_option_name(text);
    if (name.empty()) throw "expected " + expected;
    for (const char* own : kOwn)
      if (name == own) throw "expected other options than --" + std::string(own) + ", which Patchlight sets itself";
    options.push_back(text);
  }
}

}  // namespace

std::vector<JobKey> slurm_keys(SlurmConfig& slurm) {
  return {
      integer_key("slurm.shards", slurm.shards, 1, kMaxShards,
                  "number of tasks that share the rows of form factors, and the frames; 1: not shared"),
      integer_key("slurm.cpus", slurm.cpus, 1, 4096, "CPUs of a task, unless --threads is given"),
      text_key("slurm.partition", slurm.partition, is_partition, "the name of a partition, or several with commas",
               "partition of the tasks; absent: Slurm's default"),
      text_key("slurm.time", slurm.time, is_time_limit, "a time as sbatch takes it: minutes, 1:30:00 or 2-12",
               "time limit of a task; absent: Slurm's default"),
      {"slurm.options", "further options of sbatch, such as [--mem=8G]",
       [&slurm](const Node& n) { read_options(n, slurm.options); }, [&slurm] { return Node(slurm.options); }},
      integer_key("slurm.retries", slurm.retries, 0, 100, "how often a lost or killed task is resubmitted"),
  };
}

}  // namespace patchlight
