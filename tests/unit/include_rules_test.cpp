// Who may include whom. docs/architecture.md shows the same table, and a test compares the two.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/paths.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

using Names = std::set<std::string_view>;

/// The other wings, and the libraries besides the standard library and GLM, that one wing may include.
struct WingRule {
  Names wings;
  Names libraries;
};

/// A wing is a folder. The three files in kTops form wings of their own: each lies beside the wings that it joins.
const std::map<std::string_view, WingRule> kRules{
    {"core", {{}, {"spdlog", "PNG"}}},
    {"core/program", {{"core"}, {"POSIX", "CLI11"}}},

    {"io/file", {{"core"}, {"POSIX", "xxHash"}}},
    {"io/store", {{"core", "io/file"}, {"POSIX", "LZ4", "xxHash", "nlohmann"}}},
    {"io/scan", {{"core", "io/store"}, {}}},
    {"io/las", {{"core", "io/file", "io/store", "io/scan"}, {"POSIX", "LASzip"}}},
    {"io/table", {{"core", "io/file", "io/store", "io/scan"}, {"POSIX", "PCL"}}},
    {"io/synthetic", {{"core", "io/scan"}, {}}},
    {"io/open_scans", {{"core", "io/file", "io/scan", "io/las", "io/table", "io/synthetic"}, {}}},

    {"lod", {{"core", "io/store"}, {"POSIX"}}},

    {"render", {{"core"}, {"POSIX", "TBB"}}},
    {"render/plan", {{"core", "render"}, {"TBB"}}},
    {"render/shaders", {{}, {}}},
    {"render/gl", {{"core"}, {"POSIX", "GL", "EGL", "OSMesa"}}},
    {"render/flood", {{"core", "render", "render/plan", "render/gl", "render/shaders"}, {"TBB", "Highway", "GL"}}},
    {"render/picture", {{"core", "render", "render/plan", "render/flood"}, {"POSIX", "TBB", "Highway"}}},
    {"render/cpu", {{"core", "render", "render/plan", "render/picture"}, {"TBB", "Highway"}}},
    {"render/gpu",
     {{"core", "render", "render/plan", "render/gl", "render/shaders", "render/flood", "render/picture"},
      {"TBB", "GL"}}},
    {"render/progressive",
     {{"core", "render", "render/plan", "render/gl", "render/shaders", "render/flood", "render/picture", "render/gpu"},
      {"TBB", "GL"}}},
    {"render/create_rasterizer",
     {{"core", "render", "render/gl", "render/cpu", "render/gpu", "render/progressive"}, {}}},

    {"converter", {{"core", "io/scan", "io/store"}, {}}},
    {"converter/memory", {{"core"}, {"POSIX"}}},
    {"converter/survey", {{"core", "io/scan", "io/store", "converter"}, {"TBB"}}},
    {"converter/journal",
     {{"core", "io/file", "io/scan", "io/store", "converter", "converter/survey"}, {"POSIX", "xxHash"}}},
    {"converter/distribute",
     {{"core", "io/file", "io/scan", "io/store", "converter", "converter/memory", "converter/journal",
       "converter/survey"},
      {"POSIX", "TBB", "xxHash"}}},
    {"converter/build",
     {{"core", "io/file", "io/store", "converter", "converter/memory", "converter/journal", "converter/distribute"},
      {"POSIX", "TBB", "Eigen"}}},
    {"converter/normals",
     {{"core", "io/file", "io/store", "converter", "converter/memory", "converter/journal"},
      {"POSIX", "TBB", "Eigen", "PCL"}}},
    {"converter/convert",
     {{"core", "io/file", "io/scan", "io/store", "io/open_scans", "converter", "converter/journal", "converter/survey",
       "converter/distribute", "converter/build", "converter/normals"},
      {"POSIX", "TBB"}}},
    {"converter/programs",
     {{"core", "core/program", "io/file", "io/scan", "io/store", "io/open_scans", "converter", "converter/convert",
       "converter/journal", "converter/survey"},
      {"POSIX", "CLI11", "nlohmann"}}},

    {"viewer/camera", {{"core", "io/file", "io/store"}, {"nlohmann"}}},
    {"viewer/tools", {{"core", "io/store", "render/picture", "viewer/camera"}, {"nlohmann"}}},
    {"viewer/session",
     {{"core", "io/file", "io/store", "lod", "render", "render/create_rasterizer", "render/gl", "render/picture",
       "render/progressive", "viewer/camera", "viewer/tools"},
      {"POSIX", "CLI11", "nlohmann"}}},
    {"viewer/output",
     {{"core", "io/file", "lod", "render", "render/plan", "viewer/camera", "viewer/session"}, {"POSIX"}}},
    {"viewer/bench",
     {{"core", "core/program", "io/file", "io/store", "lod", "render", "render/create_rasterizer", "render/gl",
       "viewer/camera", "viewer/session", "viewer/output"},
      {"POSIX", "CLI11", "nlohmann"}}},
    {"viewer/window",
     {{"core", "core/program", "io/file", "io/store", "lod", "render", "render/create_rasterizer", "render/gl",
       "render/picture", "render/progressive", "viewer/camera", "viewer/tools", "viewer/session", "viewer/output"},
      {"POSIX", "GL", "GLFW", "ImGui", "CLI11", "nlohmann"}}},
};

/// The files that join the wings around them, and are wings of their own.
const Names kTops{"io/open_scans", "render/create_rasterizer", "converter/convert"};

/// The libraries that only one source may include.
const Names kInOneFile{"spdlog", "PNG", "OSMesa"};
/// Core holds values, and nothing in it starts a thread or waits for one. Only core/mutex.h names locks, for the
/// others.
const Names kNotInCore{"thread", "mutex",     "shared_mutex", "condition_variable",
                       "future", "semaphore", "latch",        "barrier"};

constexpr int kMaxLines = 700;

/// Libraries by the beginnings of their headers' names. A longer one comes before a shorter one: "GL/osmesa", "GL/".
const std::vector<std::pair<std::string_view, std::string_view>> kLibraries{
    {"glm/", "GLM"},     {"spdlog/", "spdlog"}, {"fmt/", "spdlog"},
    {"png.h", "PNG"},    {"laszip/", "LASzip"}, {"pcl/", "PCL"},
    {"lz4", "LZ4"},      {"xxhash", "xxHash"},  {"nlohmann/", "nlohmann"},
    {"tbb/", "TBB"},     {"oneapi/", "TBB"},    {"Eigen/", "Eigen"},
    {"hwy/", "Highway"}, {"CLI/", "CLI11"},     {"GL/osmesa", "OSMesa"},
    {"GL/", "GL"},       {"KHR/", "GL"},        {"EGL/", "EGL"},
    {"GLFW/", "GLFW"},   {"imgui", "ImGui"},    {"gtest/", "GoogleTest"},
    {"sys/", "POSIX"},   {"linux/", "POSIX"},
};
const Names kPosixHeaders{"unistd.h", "fcntl.h", "dlfcn.h", "dirent.h", "poll.h",  "pthread.h", "sched.h",
                          "signal.h", "spawn.h", "stdio.h", "stdlib.h", "errno.h", "malloc.h"};

/// "io/las/las_header.cpp" and "io/las/las_header.h" belong to the module "io/las/las_header".
std::string moduleOf(std::string_view path) { return std::string(path.substr(0, path.rfind('.'))); }

/// The wing of a file of ours; "unknown" where kRules has none.
std::string_view wingOf(std::string_view path) {
  const std::string module = moduleOf(path);
  if (const auto top = kTops.find(module); top != kTops.end()) return *top;
  const std::size_t slash = path.rfind('/');
  const auto rule = kRules.find(slash == std::string_view::npos ? path : path.substr(0, slash));
  return rule != kRules.end() ? rule->first : "unknown";
}

/// "std" for the standard library, the name of one of our wings, a library's name, or "unknown".
std::string_view ownerOf(std::string_view header) {
  for (const auto& [beginning, library] : kLibraries)
    if (header.starts_with(beginning)) return library;
  if (kPosixHeaders.contains(header)) return "POSIX";
  if (header.find('/') != std::string_view::npos) return wingOf(header);
  return header.find('.') == std::string_view::npos ? "std" : "unknown";
}

bool isHeader(std::string_view file) { return file.ends_with(".h"); }

/// The reason for which `file`, such as "io/las/las_source.cpp", must not include `header`; empty where it may.
std::string objection(std::string_view file, std::string_view header) {
  const std::string_view wing = wingOf(file);
  if (wing == "unknown") return std::string(file) + ": lies in no wing that this test knows";
  const WingRule& rule = kRules.at(wing);
  const std::string_view owner = ownerOf(header);
  const std::string where = std::string(file) + " includes " + std::string(header) + ": ";
  if (owner == "std")
    return wing == "core" && file != "core/mutex.h" && kNotInCore.contains(header) ? where + "core starts no threads"
                                                                                   : std::string();
  if (owner == "GLM" || owner == wing || rule.wings.contains(owner)) return {};
  if (kRules.contains(owner)) return where + std::string(wing) + " must not know " + std::string(owner);
  if (owner == "unknown") return where + "neither a path from the root of the sources nor a known library";
  if (!rule.libraries.contains(owner)) return where + std::string(wing) + " must not use " + std::string(owner);
  if (isHeader(file) && owner != "POSIX") return where + "a third-party header in a header of ours";
  return {};
}

std::vector<std::string> includesOf(const fs::path& file) {
  static const std::regex include(R"re(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)re");
  std::vector<std::string> headers;
  std::ifstream in(file);
  std::smatch match;
  for (std::string line; std::getline(in, line);)
    if (std::regex_match(line, match, include)) headers.push_back(match[1]);
  return headers;
}

/// The files in `folders` whose names end so, as sorted paths from the root of the sources.
std::vector<std::string> filesIn(const std::vector<std::string_view>& folders, const Names& endings) {
  const fs::path root = test::sourceFolder();
  std::vector<std::string> files;
  for (const std::string_view folder : folders)
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.is_regular_file() && endings.contains(entry.path().extension().string()))
        files.push_back(entry.path().lexically_relative(root).string());
  std::sort(files.begin(), files.end());
  return files;
}

const std::vector<std::string_view> kLayers{"core", "io", "lod", "render", "converter", "viewer"};
const std::vector<std::string_view> kLayersAndTests{"core", "io", "lod", "render", "converter", "viewer", "tests"};

/// The modules that each module includes, in its header or its source.
std::map<std::string, std::set<std::string>> moduleGraph() {
  std::map<std::string, std::set<std::string>> graph;
  for (const std::string& file : filesIn(kLayers, {".h", ".cpp"})) {
    std::set<std::string>& included = graph[moduleOf(file)];
    for (const std::string& header : includesOf(test::sourceFolder() / file))
      if (kRules.contains(ownerOf(header)) && moduleOf(header) != moduleOf(file)) included.insert(moduleOf(header));
  }
  return graph;
}

/// A circle in `graph`, as "a -> b -> a"; empty where there is none.
std::string findCircle(const std::map<std::string, std::set<std::string>>& graph) {
  std::set<std::string> finished;
  std::vector<std::string> way;
  const auto visit = [&](const auto& self, const std::string& module) -> std::string {
    if (finished.contains(module)) return {};
    const bool closes = std::find(way.begin(), way.end(), module) != way.end();
    way.push_back(module);
    if (closes) {
      std::string circle;
      for (auto at = std::find(way.begin(), way.end(), module); at != way.end(); ++at)
        circle += (circle.empty() ? "" : " -> ") + *at;
      return circle;
    }
    if (const auto node = graph.find(module); node != graph.end())
      for (const std::string& next : node->second)
        if (std::string circle = self(self, next); !circle.empty()) return circle;
    way.pop_back();
    finished.insert(module);
    return {};
  };
  for (const auto& [module, included] : graph)
    if (std::string circle = visit(visit, module); !circle.empty()) return circle;
  return {};
}

TEST(Wings, NoSourceIncludesWhatItsWingMustNotKnow) {
  const std::vector<std::string> files = filesIn(kLayers, {".h", ".cpp"});
  ASSERT_GT(files.size(), 10u);
  std::size_t includes = 0;
  for (const std::string& file : files)
    for (const std::string& header : includesOf(test::sourceFolder() / file)) {
      EXPECT_EQ(objection(file, header), "");
      ++includes;
    }
  EXPECT_GT(includes, files.size()) << "the include lines are not being found";
}

TEST(Wings, NoWingMayIncludeOneThatMayIncludeIt) {
  std::map<std::string, std::set<std::string>> graph;
  for (const auto& [wing, rule] : kRules)
    for (const std::string_view other : rule.wings) graph[std::string(wing)].insert(std::string(other));
  EXPECT_EQ(findCircle(graph), "");
}

TEST(Wings, NoModuleIncludesOneThatIncludesIt) { EXPECT_EQ(findCircle(moduleGraph()), ""); }

TEST(Wings, TheSearchForCirclesFindsOne) {
  EXPECT_EQ(findCircle({{"a", {"b", "d"}}, {"b", {"c"}}, {"c", {"b"}}, {"d", {}}}), "b -> c -> b");
  EXPECT_EQ(findCircle({{"a", {"b", "c"}}, {"b", {"c"}}, {"c", {}}}), "");
}

TEST(Wings, ALibraryThatIsHiddenIsIncludedByOneSource) {
  std::map<std::string_view, std::set<std::string>> users;
  for (const std::string& file : filesIn(kLayers, {".cpp"}))
    for (const std::string& header : includesOf(test::sourceFolder() / file))
      if (kInOneFile.contains(ownerOf(header))) users[ownerOf(header)].insert(file);
  for (const auto& [library, files] : users)
    EXPECT_EQ(files.size(), 1u) << library << " is included in " << *files.begin() << " and " << *files.rbegin();
}

TEST(Wings, TheCheckRefusesForbiddenIncludes) {
  EXPECT_NE(objection("core/box.h", "io/store/store.h"), "");
  EXPECT_NE(objection("core/view.cpp", "lz4.h"), "");
  EXPECT_NE(objection("core/log.cpp", "thread"), "");
  EXPECT_NE(objection("core/view.cpp", "core/program/exit_code.h"), "");
  EXPECT_NE(objection("lod/streamer.cpp", "core/program/stop_signal.h"), "");
  EXPECT_NE(objection("io/store/store.cpp", "lod/selection.h"), "");
  EXPECT_NE(objection("io/store/store.cpp", "io/las/las_header.h"), "");
  EXPECT_NE(objection("io/store/store.cpp", "io/scan/point_source.h"), "");
  EXPECT_NE(objection("io/store/store.cpp", "tbb/parallel_for.h"), "");
  EXPECT_NE(objection("io/table/ply_source.cpp", "io/las/las_header.h"), "");
  EXPECT_NE(objection("io/las/las_source.cpp", "io/open_scans.h"), "");
  EXPECT_NE(objection("io/las/las_source.h", "laszip/laszip_api.h"), "");
  EXPECT_NE(objection("io/las/las_source.cpp", "../core/box.h"), "");
  EXPECT_NE(objection("io/las/las_source.cpp", "somelib.h"), "");
  EXPECT_NE(objection("io/las/las_source.cpp", "boost/optional.hpp"), "");
  EXPECT_NE(objection("lod/streamer.cpp", "render/rasterizer.h"), "");
  EXPECT_NE(objection("lod/streamer.cpp", "io/las/las_source.h"), "");
  EXPECT_NE(objection("lod/streamer.cpp", "GL/gl.h"), "");
  EXPECT_NE(objection("lod/streamer.cpp", "tbb/parallel_for.h"), "");
  EXPECT_NE(objection("render/cpu/cpu_rasterizer.cpp", "io/store/store.h"), "");
  EXPECT_NE(objection("render/cpu/cpu_rasterizer.cpp", "lod/streamer.h"), "");
  EXPECT_NE(objection("render/cpu/cpu_rasterizer.cpp", "render/gl/gl_context.h"), "");
  EXPECT_NE(objection("render/rasterizer.h", "render/create_rasterizer.h"), "");
  EXPECT_NE(objection("converter/build/merge.cpp", "lod/selection.h"), "");
  EXPECT_NE(objection("converter/build/merge.cpp", "converter/convert.h"), "");
  EXPECT_NE(objection("viewer/window/viewer_app.cpp", "converter/convert.h"), "");
  EXPECT_NE(objection("viewer/session/layers.cpp", "viewer/bench/measures.h"), "");
  EXPECT_NE(objection("viewer/nowhere/main.cpp", "core/box.h"), "");
}

TEST(Wings, TheCheckAllowsWhatTheDesignAllows) {
  EXPECT_EQ(objection("core/box.h", "glm/glm.hpp"), "");
  EXPECT_EQ(objection("core/image.cpp", "png.h"), "");
  EXPECT_EQ(objection("io/las/laz_codec.cpp", "laszip/laszip_api.h"), "");
  EXPECT_EQ(objection("io/file/byte_source.cpp", "sys/stat.h"), "");
  EXPECT_EQ(objection("io/open_scans.cpp", "io/las/las_source.h"), "");
  EXPECT_EQ(objection("lod/streamer.h", "thread"), "");
  EXPECT_EQ(objection("lod/streamer.cpp", "io/store/node_codec.h"), "");
  EXPECT_EQ(objection("render/gl/osmesa_context.cpp", "GL/osmesa.h"), "");
  EXPECT_EQ(objection("render/cpu/cpu_kernel.cpp", "hwy/highway.h"), "");
  EXPECT_EQ(objection("render/create_rasterizer.cpp", "render/cpu/cpu_rasterizer.h"), "");
  EXPECT_EQ(objection("converter/convert.cpp", "converter/build/merge.h"), "");
  EXPECT_EQ(objection("converter/build/merge.cpp", "tbb/parallel_for.h"), "");
  EXPECT_EQ(objection("core/program/command_line.cpp", "CLI/CLI.hpp"), "");
  EXPECT_EQ(objection("viewer/window/window.cpp", "GLFW/glfw3.h"), "");
  EXPECT_EQ(objection("viewer/window/viewer_app.cpp", "lod/streamer.h"), "");
}

/// The wings that a row of docs/architecture.md names, in full: "file" in the row of io/las is io/file.
Names wingsNamed(std::string_view wing, const std::string& cell) {
  static const std::regex name(R"re([\w/]+)re");
  const std::string folder(wing.substr(0, wing.find('/')));
  Names named;
  for (std::sregex_iterator at(cell.begin(), cell.end(), name), end; at != end; ++at) {
    const auto neighbour = kRules.find(folder + "/" + at->str());
    const auto rule = neighbour != kRules.end() ? neighbour : kRules.find(at->str());
    if (rule != kRules.end())
      named.insert(rule->first);
    else
      ADD_FAILURE() << wing << " names " << at->str() << ", which is no wing";
  }
  return named;
}

TEST(Wings, TheArchitecturePageHasTheSameTable) {
  static const std::regex row(R"re(^\| `([\w/]+)` \| [^|]+ \| ([^|]+) \|$)re");
  std::ifstream page(test::sourceFolder() / "docs/architecture.md");
  Names found;
  std::smatch match;
  for (std::string line; std::getline(page, line);) {
    if (!std::regex_match(line, match, row)) continue;
    const auto rule = kRules.find(match[1].str());
    ASSERT_NE(rule, kRules.end()) << "docs/architecture.md has a row for " << match[1] << ", which is no wing";
    found.insert(rule->first);
    Names allowed = rule->second.wings;
    allowed.erase("core");  // which the page leaves out
    EXPECT_EQ(match[2] == "-" ? Names{} : wingsNamed(rule->first, match[2]), allowed) << rule->first;
  }
  for (const auto& [wing, rule] : kRules)
    EXPECT_TRUE(found.contains(wing)) << "docs/architecture.md has no row for " << wing;
}

TEST(Sources, NoFileIsLongerThanSevenHundredLines) {
  for (const std::string& file : filesIn(kLayersAndTests, {".h", ".cpp", ".glsl", ".comp", ".vert", ".frag"})) {
    std::ifstream in(test::sourceFolder() / file);
    int lines = 0;
    for (std::string line; std::getline(in, line);) ++lines;
    EXPECT_LE(lines, kMaxLines) << file;
  }
}

/// The text of the nearest CMakeLists.txt at or above the folder of `file`, and the file's path from there.
std::pair<std::string, std::string> nearestList(const fs::path& file) {
  fs::path folder = file.parent_path();
  while (!fs::exists(folder / "CMakeLists.txt")) folder = folder.parent_path();
  std::ifstream in(folder / "CMakeLists.txt");
  return {std::string(std::istreambuf_iterator<char>(in), {}), file.lexically_relative(folder).string()};
}

/// True when `list` names the file, or forms its name in a loop: `fuzz/${name}_fuzz.cpp` where `text` is a name.
bool isListed(const std::string& list, const std::string& file) {
  if (list.find(file) != std::string::npos) return true;
  static const std::regex pattern(R"re(([\w/]*)\$\{name\}([\w.]*\.cpp))re");
  for (std::sregex_iterator at(list.begin(), list.end(), pattern), end; at != end; ++at) {
    const std::string before = (*at)[1], after = (*at)[2];
    if (!file.starts_with(before) || !file.ends_with(after) || file.size() <= before.size() + after.size()) continue;
    const std::string name = file.substr(before.size(), file.size() - before.size() - after.size());
    if (std::regex_search(list, std::regex("\\b" + name + "\\b"))) return true;
  }
  return false;
}

TEST(Sources, EveryCppIsListedInACMakeListsFile) {
  for (const std::string& file : filesIn(kLayersAndTests, {".cpp"})) {
    const auto [list, name] = nearestList(test::sourceFolder() / file);
    EXPECT_TRUE(isListed(list, name)) << file << " is in no CMakeLists.txt";
  }
}

TEST(Sources, TheCheckSeesAFileThatIsNotListed) {
  const std::string list = "add_library(a one.cpp)\nforeach(name text las)\n add_executable(x fuzz/${name}_fuzz.cpp)";
  EXPECT_TRUE(isListed(list, "one.cpp"));
  EXPECT_TRUE(isListed(list, "fuzz/text_fuzz.cpp"));
  EXPECT_FALSE(isListed(list, "two.cpp"));
  EXPECT_FALSE(isListed(list, "fuzz/ply_fuzz.cpp"));
}

/// `text` without comments, preprocessor lines and literals.
std::string codeOf(std::istream& in) {
  static const std::regex literal(R"re("(\\.|[^"\\])*"|'(\\.|[^'\\])+')re");
  std::string code;
  for (std::string line; std::getline(in, line);) {
    if (const std::size_t first = line.find_first_not_of(' '); first == std::string::npos || line[first] == '#')
      continue;
    line = std::regex_replace(line, literal, "");
    code += line.substr(0, line.find("//")) + "\n";
  }
  return code;
}

/// The classes, structs and enums that C++ code defines at namespace scope, as "strata::suite::Cloud".
std::set<std::string> typesDefinedIn(const std::string& code) {
  static const std::regex token(R"re(\w+|::|.)re");
  std::vector<std::string> tokens;
  for (std::sregex_iterator at(code.begin(), code.end(), token), end; at != end; ++at)
    if (at->str() != " ") tokens.push_back(at->str());

  std::set<std::string> types;
  std::vector<std::string> scopes;  // one per open brace: "strata::" for a namespace, "" for anything else
  const auto qualified = [&](const std::string& name) {
    std::string path;
    for (const std::string& scope : scopes) path += scope;
    return path + name;
  };
  std::string opening;  // what the next brace opens
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string& word = tokens[i];
    if (word == "{") scopes.push_back(std::exchange(opening, ""));
    if (word == "}" && !scopes.empty()) scopes.pop_back();
    if (word == "namespace") {
      opening = "";
      for (std::size_t k = i + 1; k < tokens.size() && tokens[k] != "{" && tokens[k] != ";"; ++k) opening += tokens[k];
      opening += "::";
    }
    if (word != "class" && word != "struct" && word != "enum") continue;
    if (std::find(scopes.begin(), scopes.end(), "") != scopes.end()) continue;
    // The name is the last word before the bases or the brace; a macro with arguments may come before it.
    std::string name;
    std::size_t k = i + 1;
    for (; k < tokens.size() && std::string(":{;<>,=)").find(tokens[k]) == std::string::npos; ++k) {
      if (tokens[k] == "(")
        k = static_cast<std::size_t>(std::find(tokens.begin() + static_cast<std::ptrdiff_t>(k), tokens.end(), ")") -
                                     tokens.begin());
      else if (tokens[k] != "final" && tokens[k] != "class" && tokens[k] != "struct")
        name = tokens[k];
    }
    if (k >= tokens.size()) break;
    const bool hasBases = tokens[k] == ":";
    while (hasBases && k < tokens.size() && tokens[k] != "{" && tokens[k] != ";") ++k;
    if (k < tokens.size() && tokens[k] == "{" && !name.empty()) types.insert(qualified(name));
    i = k - 1;
  }
  return types;
}

/// The files that define each type, of those types that several files define.
std::map<std::string, std::set<std::string>> definedTwice(const std::map<std::string, std::string>& codeOfFiles) {
  std::map<std::string, std::set<std::string>> files;
  for (const auto& [file, code] : codeOfFiles)
    for (const std::string& type : typesDefinedIn(code)) files[type].insert(file);
  std::erase_if(files, [](const auto& type) { return type.second.size() < 2; });
  return files;
}

// Two types of one name are one type to the linker, which then takes the functions of either for both.
TEST(Sources, ATypeNameIsDefinedOnce) {
  std::map<std::string, std::string> headers;
  std::size_t types = 0;
  for (const std::string& file : filesIn(kLayers, {".h"})) {
    std::ifstream in(test::sourceFolder() / file);
    headers[file] = codeOf(in);
    types += typesDefinedIn(headers[file]).size();
  }
  EXPECT_GT(types, headers.size()) << "the types are not being found";
  for (const auto& [type, files] : definedTwice(headers))
    ADD_FAILURE() << type << " is defined in " << *files.begin() << " and in " << *files.rbegin();
}

TEST(Sources, TheCheckSeesATypeThatIsDefinedTwice) {
  std::istringstream text(
      "#define X struct A {\n"
      "namespace strata {\n// struct B {\nclass C;\ntemplate <class T>\nclass D final : public E<T> {\n  struct F "
      "{};\n};\n"
      "namespace suite {\nenum class G : int { a, b };\n}\nstruct MACRO(\"x{\") H {\n};\nstruct I {\n} i;\n}\n");
  const std::string code = codeOf(text);
  EXPECT_EQ(typesDefinedIn(code), (std::set<std::string>{"strata::D", "strata::suite::G", "strata::H", "strata::I"}));
  const auto twice = definedTwice({{"a.h", code}, {"b.h", "namespace strata { struct H { int h; }; struct G {}; }"}});
  EXPECT_EQ(twice, (std::map<std::string, std::set<std::string>>{{"strata::H", {"a.h", "b.h"}}}));
}

}  // namespace
}  // namespace strata
