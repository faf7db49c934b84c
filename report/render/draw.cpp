/// Runs gnuplot, without a shell, on the scripts of gnuplot.cpp.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <future>
#include <sstream>
#include <thread>

#include "report/render/render.hpp"
#include "report/report.hpp"

extern char** environ;

namespace polhode::report {
namespace {

/// Runs gnuplot on NAME.gp inside `folder`, once after each command of `before`; returns what went wrong, or nothing.
std::string run_gnuplot(std::string const& name, std::filesystem::path const& folder, std::vector<std::string> before) {
  std::string script = name + ".gp", program = "gnuplot", plain = "--default-settings", first = "-e";
  std::vector<char*> arguments{program.data(), plain.data()};
  for (std::string& command : before) {
    for (std::string* word : {&first, &command, &script}) arguments.push_back(word->data());
  }
  arguments.push_back(nullptr);
  std::string const log = name + ".log";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  pid_t child = 0;
  int const failure = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) return "gnuplot is not on the PATH";
  if (failure != 0) return fmt::format("gnuplot cannot be started: {}", std::strerror(failure));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  return fmt::format("gnuplot failed, see figures/{}", log);
}

}  // namespace

void draw(Figure& figure, std::filesystem::path const& folder) {
  std::filesystem::path const script = folder / (figure.name + ".gp");
  std::filesystem::path const picture = folder / (figure.name + ".svg");
  std::error_code ignored;
  std::filesystem::path const print = folder / (figure.name + ".pdf");
  // pictures of earlier records must not pass for these
  std::filesystem::remove(picture, ignored);
  std::filesystem::remove(print, ignored);
  std::ofstream out(script);
  out << gnuplot_script(figure);
  out.close();
  if (!out) throw ReportError(fmt::format("{}: cannot be written", script.string()));
  if (!run_gnuplot(figure.name, folder, {"pdf = 0", "pdf = 1"}).empty()) {
    // A gnuplot without Cairo draws no PDF: the report is complete all the same.
    figure.why_not = run_gnuplot(figure.name, folder, {"pdf = 0"});
    if (!figure.why_not.empty()) return;
    std::filesystem::remove(print, ignored);
  }
  std::filesystem::remove(folder / (figure.name + ".log"), ignored);
  std::ifstream in(picture);
  std::ostringstream svg;
  svg << in.rdbuf();
  if (svg.str().find("</svg>") == std::string::npos) {
    figure.why_not = "gnuplot left no complete picture";
    return;
  }
  figure.svg = svg.str();
}

void draw_all(std::vector<Figure*> const& figures, std::filesystem::path const& folder) {
  std::size_t const workers = std::min<std::size_t>(figures.size(), std::max(1U, std::thread::hardware_concurrency()));
  std::atomic<std::size_t> next = 0;
  auto const work = [&] {
    for (std::size_t i = next++; i < figures.size(); i = next++) draw(*figures[i], folder);
  };
  std::vector<std::future<void>> running;
  for (std::size_t i = 0; i < workers; ++i) running.push_back(std::async(std::launch::async, work));
  for (auto& one : running) one.get();
}

}  // namespace polhode::report
