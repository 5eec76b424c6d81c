// The documents name files that exist, link to places that exist, and keep their lines within 120 columns.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/version.h"
#include "tests/support/paths.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostColumns = 120;

/// All files of the repository that the documents may name, as paths from its root; generated folders are left out.
const std::set<std::string>& repositoryFiles() {
  static const std::set<std::string> files = [] {
    const fs::path root = test::sourceFolder();
    std::set<std::string> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(root))
      if (entry.is_regular_file()) found.insert(entry.path().filename().string());
    for (const char* folder : {"core", "io", "lod", "render", "converter", "viewer", "tests", "docs", ".ci"})
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder))
        if (entry.is_regular_file()) found.insert(entry.path().lexically_relative(root).string());
    return found;
  }();
  return files;
}

std::vector<std::string> documents() {
  std::vector<std::string> pages;
  for (const std::string& file : repositoryFiles())
    if (file.ends_with(".md")) pages.push_back(file);
  return pages;
}

struct Line {
  std::string text;
  int number = 0;
  bool code = false;  ///< fenced, or indented by four columns or more
  bool table = false;
};

std::vector<Line> linesOf(std::istream& in) {
  std::vector<Line> lines;
  bool fenced = false;
  int number = 0;
  for (std::string text; std::getline(in, text);) {
    Line line{text, ++number};
    const bool fence = text.starts_with("```");
    line.code = fenced || fence || text.starts_with("    ");
    line.table = text.starts_with("|");
    if (fence) fenced = !fenced;
    lines.push_back(line);
  }
  return lines;
}

std::vector<Line> linesOfPage(const std::string& page) {
  std::ifstream in(test::sourceFolder() / page);
  return linesOf(in);
}

/// UTF-8 code points.
std::size_t columns(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

/// The contents of `spans` like this one.
std::vector<std::string> codeSpans(const std::string& text) {
  static const std::regex span("`([^`]+)`");
  std::vector<std::string> spans;
  for (std::sregex_iterator at(text.begin(), text.end(), span), end; at != end; ++at) spans.push_back((*at)[1]);
  return spans;
}

/// The targets of Markdown links and images.
std::vector<std::string> links(const std::string& text) {
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  std::vector<std::string> targets;
  for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) targets.push_back((*at)[1]);
  return targets;
}

/// True for a word that has the form of one of our files: a path with a known ending, or the bare name of a source.
bool namesAFile(const std::string& word) {
  static const std::regex path(
      R"([\w.*-]+(/[\w.*-]+)+\.(h|cpp|md|sh|py|json|glsl|comp|vert|frag|svg|png|jpg|txt|cmake))");
  static const std::regex source(R"([\w*-]+\.(h|cpp|sh|py|glsl|comp|vert|frag))");
  return std::regex_match(word, path) || std::regex_match(word, source);
}

/// True when a file has this path, seen from the root or from the folder of the page, or this bare name. A `*`
/// matches any part of a name.
bool exists(const std::string& word, const fs::path& pageFolder) {
  std::string pattern;
  for (const char c : word) {
    if (c == '*')
      pattern += "[^/]*";
    else
      pattern += std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '/' ? std::string(1, c)
                                                                                     : std::string("\\") + c;
  }
  const bool bare = word.find('/') == std::string::npos;
  const std::regex whole(bare ? "(.*/)?" + pattern : pattern);
  const std::regex fromPage((pageFolder.empty() ? "" : pageFolder.string() + "/") + pattern);
  return std::any_of(repositoryFiles().begin(), repositoryFiles().end(), [&](const std::string& file) {
    return std::regex_match(file, whole) || std::regex_match(file, fromPage);
  });
}

/// The anchor that a heading gets: lower case, blanks as hyphens, no punctuation.
std::string anchorOf(const std::string& heading) {
  std::string anchor;
  for (const char c : heading.substr(heading.find_first_not_of("# ")))
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || (c & 0x80) != 0)
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (c == ' ')
      anchor += '-';
  return anchor;
}

bool hasAnchor(const std::string& page, const std::string& anchor) {
  for (const Line& line : linesOfPage(page))
    if (!line.code && line.text.starts_with("#") && anchorOf(line.text) == anchor) return true;
  return false;
}

/// Why a link on `page` leads nowhere; empty when it does not.
std::string linkObjection(const std::string& page, const std::string& target) {
  if (target.find("://") != std::string::npos || target.starts_with("mailto:")) return {};
  const std::size_t hash = target.find('#');
  const std::string path = target.substr(0, hash);
  const std::string file = path.empty() ? page : (fs::path(page).parent_path() / path).lexically_normal().string();
  if (!fs::exists(test::sourceFolder() / file)) return file + " does not exist";
  if (hash == std::string::npos) return {};
  return hasAnchor(file, target.substr(hash + 1)) ? "" : file + " has no heading " + target.substr(hash);
}

TEST(Documents, EveryLinkLeadsSomewhere) {
  std::size_t checked = 0;
  for (const std::string& page : documents())
    for (const Line& line : linesOfPage(page))
      for (const std::string& target : links(line.code ? std::string() : line.text)) {
        EXPECT_EQ(linkObjection(page, target), "") << page << ":" << line.number;
        ++checked;
      }
  EXPECT_GT(checked, 30u) << "the links are not being found";
}

TEST(Documents, EveryFileThatIsNamedExists) {
  std::size_t checked = 0;
  for (const std::string& page : documents())
    for (const Line& line : linesOfPage(page))
      for (const std::string& span : codeSpans(line.text)) {
        std::istringstream words(span);
        for (std::string word; words >> word;) {
          if (!namesAFile(word)) continue;
          EXPECT_TRUE(exists(word, fs::path(page).parent_path())) << page << ":" << line.number << ": " << word;
          ++checked;
        }
      }
  EXPECT_GT(checked, 30u) << "the names of files are not being found";
}

/// All words of the sources and scripts that have the form of an identifier.
const std::set<std::string>& identifiers() {
  static const std::set<std::string> words = [] {
    static const std::set<std::string> endings{".h", ".cpp", ".glsl", ".comp", ".vert", ".frag"};
    std::set<std::string> found;
    for (const std::string& file : repositoryFiles()) {
      if (!endings.contains(fs::path(file).extension().string())) continue;
      std::ifstream in(test::sourceFolder() / file);
      std::string word;
      for (char c = 0; in.get(c);) {
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') {
          word += c;
        } else if (!word.empty()) {
          found.insert(word);
          word.clear();
        }
      }
      found.insert(word);
    }
    return found;
  }();
  return words;
}

/// True for `Type::member`, `function()` and `CamelCase`.
bool namesCode(const std::string& span) {
  static const std::regex code(R"((\w+::)+\w+(\(\))?|\w+\(\)|[A-Z][a-z0-9]+([A-Z][a-z0-9]*)+)");
  return std::regex_match(span, code);
}

TEST(Documents, EveryTypeAndFunctionThatIsNamedExists) {
  static const std::regex identifier(R"(\w+)");
  std::size_t checked = 0;
  for (const std::string& page : documents())
    for (const Line& line : linesOfPage(page))
      for (const std::string& span : codeSpans(line.text)) {
        if (!namesCode(span)) continue;
        for (std::sregex_iterator at(span.begin(), span.end(), identifier), end; at != end; ++at)
          EXPECT_TRUE(identifiers().contains(at->str())) << page << ":" << line.number << ": " << span;
        ++checked;
      }
  EXPECT_GT(checked, 60u) << "the names of types and functions are not being found";
}

TEST(Documents, NoLineIsWiderThan120ColumnsOutsideOfTablesAndCode) {
  for (const std::string& page : documents())
    for (const Line& line : linesOfPage(page))
      if (!line.code && !line.table) {
        EXPECT_LE(columns(line.text), kMostColumns) << page << ":" << line.number;
      }
}

TEST(Documents, TheChangelogBeginsWithTheVersionThatIsBuilt) {
  std::ifstream in(test::sourceFolder() / "CHANGELOG.md");
  std::string line;
  while (std::getline(in, line) && !line.starts_with("## ")) continue;
  EXPECT_EQ(line.substr(0, line.find(" (")), "## " + version());
}

TEST(Documents, TheChecksSeeWhatIsWrong) {
  EXPECT_TRUE(namesAFile("core/box.h"));
  EXPECT_TRUE(namesAFile("visibility.h"));
  EXPECT_FALSE(namesAFile("store.json"));
  EXPECT_FALSE(namesAFile("LevelOrder::kAll"));
  EXPECT_FALSE(namesAFile("tiles/"));
  EXPECT_TRUE(namesCode("LevelOrder::kAll") && namesCode("selectNodes()") && namesCode("NodeCache"));
  EXPECT_FALSE(namesCode("points") || namesCode("--memory") || namesCode("GL_POINTS"));
  EXPECT_FALSE(
      identifiers().contains("NoSuch"
                             "Type"));
  EXPECT_TRUE(exists("core/box.h", "docs"));
  EXPECT_TRUE(exists("box.h", "docs"));
  EXPECT_TRUE(exists("flood_*.comp", "docs"));
  EXPECT_FALSE(exists("core/nothing.h", "docs"));
  EXPECT_FALSE(exists("coreXbox.h", "docs"));
  EXPECT_FALSE(exists("ox.h", "docs"));
  EXPECT_EQ(linkObjection("docs/architecture.md", "format.md"), "");
  EXPECT_EQ(linkObjection("docs/architecture.md", "https://example.org/nothing.md"), "");
  EXPECT_NE(linkObjection("docs/architecture.md", "nothing.md"), "");
  EXPECT_NE(linkObjection("docs/architecture.md", "format.md#no-such-heading"), "");
  EXPECT_EQ(anchorOf("## How good it is, how steady, and what it costs"),
            "how-good-it-is-how-steady-and-what-it-costs");
  EXPECT_EQ(columns("µs"), 2u);
  std::istringstream page("text\n```\ncode\n```\n    code\n| table |\n");
  const std::vector<Line> lines = linesOf(page);
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_FALSE(lines[0].code || lines[5].code);
  EXPECT_TRUE(lines[1].code && lines[2].code && lines[3].code && lines[4].code && lines[5].table);
}

}  // namespace
}  // namespace strata
