#pragma once
/// What the tests of the report share: a folder that goes with its test, and readers of what was written into it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "report/report.hpp"
#include "tests/report/samples.hpp"

namespace polhode::report::samples {

namespace fs = std::filesystem;
/// A folder that goes with its test.
struct Folder {
  fs::path path =
      fs::path(testing::TempDir()) /
      fmt::format("polhode report's-{}-{}", ::getpid(), testing::UnitTest::GetInstance()->current_test_info()->name());
  Folder() { fs::remove_all(path); }
  explicit Folder(fs::path other) : path(std::move(other)) { fs::remove_all(path); }
  ~Folder() {
    if (std::getenv("POLHODE_KEEP_REPORTS") == nullptr) fs::remove_all(path);
  }
};

inline std::string slurp(fs::path const& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline bool contains(std::string const& text, std::string_view what) {
  return text.find(what) != std::string::npos;
}

inline bool have_gnuplot() {
  std::istringstream path(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(path, folder, ':');) {
    if (fs::exists(fs::path(folder) / "gnuplot")) return true;
  }
  return false;
}

/// Enough of an XML reader to know that tags nest and close, and that no bare & or < stands in the text.
inline bool is_well_formed(std::string const& xml) {
  std::vector<std::string> open;
  for (std::size_t i = 0; i < xml.size(); ++i) {
    if (xml[i] == '&') {
      auto const end = xml.find(';', i);
      if (end == std::string::npos || end - i > 8) return false;
    }
    if (xml[i] != '<') continue;
    auto const end = xml.find('>', i);
    if (end == std::string::npos) return false;
    std::string const tag = xml.substr(i + 1, end - i - 1);
    if (tag.find('<') != std::string::npos) return false;
    std::string const name = tag.substr(0, tag.find_first_of(" \t\n/", 1));
    if (tag.starts_with("/")) {
      if (open.empty() || "/" + open.back() != tag) return false;
      open.pop_back();
    } else if (!tag.starts_with("?") && !tag.starts_with("!") && !tag.ends_with("/")) {
      open.push_back(name);
    }
    i = end;
  }
  return open.empty();
}

/// The page without what its script elements hold, which is neither markup nor text.
inline std::string without_scripts(std::string html) {
  constexpr std::string_view closing = "</script>";
  for (auto at = html.find("<script"); at != std::string::npos; at = html.find("<script", at)) {
    auto const end = html.find(closing, at);
    if (end == std::string::npos) return html;
    html.erase(at, end + closing.size() - at);
  }
  return html;
}

/// Writes the report and returns its Markdown.
inline std::string markdown_of(Contents const& contents, fs::path const& out) {
  write_report(contents, out);
  return slurp(out / "report.md");
}

inline void expect_sound(fs::path const& out) {
  for (auto const* file : {"report.md", "report.html"}) {
    std::string const text = without_scripts(slurp(out / file));
    EXPECT_FALSE(text.empty());
    EXPECT_FALSE(contains(text, " nan")) << file;
    EXPECT_FALSE(contains(text, " inf ")) << file;
  }
  // The head holds meta elements, which HTML does not close.
  std::string const html = without_scripts(slurp(out / "report.html"));
  EXPECT_TRUE(is_well_formed(html.substr(html.find("<body>"), html.find("</html>") - html.find("<body>"))));
}

}  // namespace polhode::report::samples
