/// Commands that the Markdown files show: the command line knows their verbs and flags.
#include <gmock/gmock.h>

#include <regex>

#include "tests/cli/process.hpp"
#include "tests/support/documents.hpp"

namespace polhode::cli {
namespace {

/// A verb with what follows it.
struct Command {
  std::string verb, rest;
};

/// The `polhode VERB ...` of a text: in blocks of code, where a backslash continues a line, and in spans of it.
std::vector<Command> commands_in(std::string const& markdown) {
  static std::regex const span("`([^`\n]+)`"), continued(R"(\\\n)"), command(R"(\bpolhode ([a-z]+)\b([^|;&\n]*))");
  test::Parts const parts = test::parts_of(markdown);
  std::string code = std::regex_replace(parts.code, continued, " ");
  for (std::sregex_iterator at(parts.prose.begin(), parts.prose.end(), span), end; at != end; ++at)
    code += at->str(1) + '\n';
  std::vector<Command> all;
  for (std::sregex_iterator at(code.begin(), code.end(), command), end; at != end; ++at)
    all.push_back({at->str(1), at->str(2)});
  return all;
}

TEST(CommandsOfDocuments, AreFoundInCode) {
  std::vector<Command> const found =
      commands_in("`polhode a --x` polhode b\n```sh\npolhode c \\\n  --y | polhode d\n```\n");
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].verb + found[1].verb + found[2].verb, "cda");
  EXPECT_THAT(found[0].rest, testing::HasSubstr("--y"));
}

TEST(CommandsOfDocuments, HaveVerbsAndFlagsThatAreKnown) {
  static std::regex const flag("--[a-z][a-z-]*");
  Folder const folder;
  std::map<std::string, std::string> help;
  int flags = 0;
  for (fs::path const& document : test::documents())
    for (auto const& [verb, rest] : commands_in(test::contents(document))) {
      if (!help.contains(verb)) {
        Result const asked = polhode(folder, verb + " --help");
        EXPECT_EQ(asked.code, 0) << document << ": polhode " << verb;
        help[verb] = asked.out;
      }
      for (std::sregex_iterator at(rest.begin(), rest.end(), flag), end; at != end; ++at, ++flags)
        EXPECT_TRUE(std::regex_search(help[verb], std::regex(at->str() + "[^a-z-]")))
            << document << ": polhode " << verb << rest;
    }
  EXPECT_GT(help.size(), 10U);
  EXPECT_GT(flags, 40);
}

}  // namespace
}  // namespace polhode::cli
