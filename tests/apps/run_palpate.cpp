// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "run_palpate.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "output_schema.h"
#include "repository.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

/// A status above this is that of a wrong call or a signal; help may be all that was printed.
constexpr int kFiguresPrinted = 1;

/// In the child: limits, redirections, and the program itself.
[[noreturn]] void become_palpate(const std::vector<std::string>& arguments,
                                 const CommandOptions& options, const std::string& in,
                                 const std::string& out, const std::string& err) {
  dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
  dup2(open(in.c_str(), O_RDONLY), STDIN_FILENO);
  setpgid(0, 0);
  signal(SIGINT, SIG_DFL);  // a shell may have started the tests with SIGINT ignored
  if (options.max_file_size) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{*options.max_file_size, *options.max_file_size};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  for (const std::string& variable : options.environment)
    putenv(const_cast<char*>(variable.c_str()));
  std::vector<char*> argv;
  std::string program = PALPATE_COMMAND;
  argv.push_back(program.data());
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  execv(PALPATE_COMMAND, argv.data());
  _exit(127);
}

}  // namespace

CommandResult run_palpate(const std::vector<std::string>& arguments,
                          const CommandOptions& options) {
  const ScratchFolder scratch;
  const std::string in = scratch / "in", out = scratch / "out", err = scratch / "err";
  write_text(in, options.answers);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become_palpate(arguments, options, in, out, err);
  int status = 0;
  if (options.interrupt_when_there_is) {
    // Ends with the child, which then is left for the wait below.
    siginfo_t ended{};
    while (!fs::exists(*options.interrupt_when_there_is) && ended.si_pid == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
    }
    kill(-child, options.signal);
  }
  waitpid(child, &status, 0);
  CommandResult result{.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                       .out = read_text(out),
                       .err = read_text(err)};
  const std::optional<std::string> command = command_with_figures(arguments);
  if (command && !result.out.empty() && result.status <= kFiguresPrinted) {
    EXPECT_EQ(differences_from_schema(*command, result.out), "");
  }
  return result;
}

fs::path demo_data() { return repository("demo"); }

std::string demo(const std::string& name) { return (demo_data() / name).string(); }

const std::string& trained_colors() {
  static const std::string colors = [] {
    const ScratchFolder folder;
    const CommandResult trained =
        run_palpate({"calibrate", "colors", demo("training"), "-o", folder / "colors.yaml"});
    EXPECT_EQ(trained.status, kDone) << trained.err;
    EXPECT_EQ(trained.err.find("warning: "), std::string::npos) << trained.err;
    return read_text(folder / "colors.yaml");
  }();
  return colors;
}

ScratchFolder::ScratchFolder() {
  std::string name = (fs::temp_directory_path() / "palpate-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  path_ = name;
}

ScratchFolder::~ScratchFolder() { fs::remove_all(path_); }

std::vector<std::string> listed_commands(const std::string& help) {
  // A name, and its description in the column of all descriptions.
  constexpr std::size_t kDescriptions = 30;
  std::istringstream lines(help);
  std::vector<std::string> commands;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = line.find("  ", 2);
    if (!line.starts_with("  ") || line.find_first_not_of(' ', end) != kDescriptions) continue;
    if (std::islower(static_cast<unsigned char>(line[2])) != 0)
      commands.push_back(line.substr(2, end - 2));
  }
  return commands;
}

std::string lines_below(const std::string& csv, std::size_t column, int limit) {
  std::istringstream lines(csv);
  std::string line, result;
  std::getline(lines, line);
  result = line + "\n";
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (std::size_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
    if (std::stoi(cell) < limit) result += line + "\n";
  }
  return result;
}

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

}  // namespace palpate::apps
