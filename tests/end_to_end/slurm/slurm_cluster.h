#pragma once
#include <arpa/inet.h>
#include <fcntl.h>
#include <pwd.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/temporary_folder.h"

extern char** environ;

namespace patchlight::test {

/// A Slurm cluster of this machine: starts munged, slurmctld and slurmd as the user of the test and stops them in the
/// destructor. Child processes find the cluster by $SLURM_CONF.
class SlurmCluster {
 public:
  static bool is_installed() {
    return std::system(
               "PATH=$PATH:/usr/sbin:/sbin; for p in sbatch slurmctld slurmd munged; do command -v $p || exit 1; done "
               ">/dev/null") == 0;
  }

  /// Starts the cluster. Returns an empty text, or the reason why it does not run.
  std::string start() {
    std::string folder = (std::filesystem::temp_directory_path() / "patchlight-slurm.XXXXXX").string();
    if (!::mkdtemp(folder.data())) return "cannot make " + folder;
    folder_ = folder;
    ::setenv("PATH", (std::string(std::getenv("PATH")) + ":/usr/sbin:/sbin").c_str(), 1);
    write_key();
    write_config();
    ::setenv("SLURM_CONF", (folder_ / "slurm.conf").c_str(), 1);
    spawn({"munged", "--foreground", "--force", "--socket=" + at("munge.sock"), "--key-file=" + at("munge.key"),
           "--pid-file=" + at("munged.pid"), "--log-file=" + at("munged.log"), "--seed-file=" + at("munge.seed")},
          "munged");
    if (!within(20, [&] { return std::filesystem::exists(folder_ / "munge.sock"); })) return logs();
    spawn({"slurmctld", "-D", "-f", at("slurm.conf")}, "slurmctld");
    spawn({"slurmd", "-D", "-f", at("slurm.conf")}, "slurmd");
    if (!within(60, [&] { return output("sinfo --noheader --format=%t") == "idle\n"; })) return logs();
    return "";
  }

  ~SlurmCluster() {
    if (folder_.empty()) return;
    if (daemons_.size() == 3) {
      output("scancel --quiet $(squeue --noheader --format=%A)");
      within(20, [&] { return output("squeue --noheader").empty(); });
    }
    for (auto daemon = daemons_.rbegin(); daemon != daemons_.rend(); ++daemon) {
      ::kill(*daemon, SIGTERM);
      if (!within(20, [&] { return ::waitpid(*daemon, nullptr, WNOHANG) == *daemon; })) {
        ::kill(*daemon, SIGKILL);
        ::waitpid(*daemon, nullptr, 0);
      }
    }
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// Output of a shell command, stderr included.
  static std::string output(const std::string& command) {
    std::string text;
    std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    std::array<char, 4096> part;
    while (const std::size_t count = std::fread(part.data(), 1, part.size(), pipe)) text.append(part.data(), count);
    ::pclose(pipe);
    return text;
  }

  /// Polls a condition until it holds; false if it does not within this time.
  template <class Condition>
  static bool within(double seconds, Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
  }

 private:
  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  void write_key() const {
    std::random_device random;
    std::ofstream key(folder_ / "munge.key", std::ios::binary);
    for (int k = 0; k < 128; ++k) key.put(char(random()));
    key.close();
    ::chmod(at("munge.key").c_str(), 0400);
  }

  void write_config() const {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    const std::string name = std::string(host.data()).substr(0, std::string(host.data()).find('.'));
    const std::string user = ::getpwuid(::getuid())->pw_name;
    std::filesystem::create_directory(folder_ / "state");
    std::filesystem::create_directory(folder_ / "spool");
    const auto [controller, node] = free_ports();
    std::ofstream(folder_ / "slurm.conf")
        << "ClusterName=patchlight\nSlurmctldHost=" << name << "(127.0.0.1)\nSlurmUser=" << user
        << "\nSlurmdUser=" << user << "\nAuthType=auth/munge\nAuthInfo=socket=" << at("munge.sock")
        << "\nCredType=cred/munge\nStateSaveLocation=" << at("state") << "\nSlurmdSpoolDir=" << at("spool")
        << "\nSlurmctldPidFile=" << at("slurmctld.pid") << "\nSlurmdPidFile=" << at("slurmd.pid")
        << "\nSlurmctldLogFile=" << at("slurmctld.log") << "\nSlurmdLogFile=" << at("slurmd.log")
        << "\nSlurmctldPort=" << controller << "\nSlurmdPort=" << node << "\nNodeName=" << name
        << R"( NodeAddr=127.0.0.1 CPUs=4
PartitionName=main Nodes=ALL Default=YES
PartitionName=other Nodes=ALL
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1
SlurmdParameters=config_overrides
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
KillWait=5
)";
  }

  static std::pair<int, int> free_ports() {
    std::array<int, 2> sockets, ports;
    for (int k = 0; k < 2; ++k) {
      sockets[k] = ::socket(AF_INET, SOCK_STREAM, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      socklen_t size = sizeof address;
      ::bind(sockets[k], reinterpret_cast<sockaddr*>(&address), size);
      ::getsockname(sockets[k], reinterpret_cast<sockaddr*>(&address), &size);
      ports[k] = ntohs(address.sin_port);
    }
    for (const int socket : sockets) ::close(socket);
    return {ports[0], ports[1]};
  }

  /// Starts a daemon that receives SIGTERM when the test process ends in any way.
  void spawn(std::vector<std::string> words, const std::string& name) {
    words.insert(words.begin(), {"setpriv", "--pdeathsig", "TERM"});
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, at(name + ".out").c_str(), O_CREAT | O_WRONLY, 0600);
    posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
    pid_t child = 0;
    if (posix_spawnp(&child, words[0].c_str(), &files, nullptr, argv.data(), environ) == 0) daemons_.push_back(child);
    posix_spawn_file_actions_destroy(&files);
  }

  std::string logs() const {
    std::string text = "Slurm is installed but does not start:\n";
    for (const char* name : {"munged.out", "munged.log", "slurmctld.out", "slurmctld.log", "slurmd.out", "slurmd.log"})
      text += std::string("== ") + name + "\n" + read_text(folder_ / name);
    return text;
  }

  std::filesystem::path folder_;
  std::vector<pid_t> daemons_;
};

}  // namespace patchlight::test
