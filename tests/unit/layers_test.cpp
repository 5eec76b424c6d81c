// Who may include whom. The rules are those of docs/architecture.md; this file is where they are enforced.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace strata {
namespace {

namespace fs = std::filesystem;

using Names = std::set<std::string_view>;

/// What a layer may include besides itself, the standard library and GLM.
struct LayerRule {
  Names layers;
  Names libraries;
};

const std::map<std::string_view, LayerRule> kRules{
    {"core", {{}, {"spdlog", "PNG"}}},
    {"io", {{"core"}, {"POSIX", "LASzip", "PCL", "LZ4", "xxHash", "nlohmann"}}},
    {"lod", {{"core", "io"}, {"POSIX"}}},
    {"render", {{"core"}, {"POSIX", "GL", "EGL", "OSMesa", "TBB", "Highway"}}},
    {"converter", {{"core", "io"}, {"POSIX", "TBB", "Eigen", "xxHash", "CLI11", "nlohmann"}}},
    {"viewer", {{"core", "io", "lod", "render"}, {"POSIX", "GL", "GLFW", "ImGui", "CLI11", "nlohmann"}}},
};

/// Libraries that stand in exactly one .cpp of ours.
const Names kInOneFile{"spdlog", "PNG", "OSMesa"};
/// Core holds values: nothing of it starts a thread or waits for one.
const Names kNotInCore{"thread", "mutex",     "shared_mutex", "condition_variable",
                       "future", "semaphore", "latch",        "barrier"};

constexpr int kMaxLines = 700;

/// Beginnings of header names, the longer before the shorter ("GL/osmesa.h" before "GL/").
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

/// "std" for the standard library, one of our folders' names, a library's name, or "unknown".
std::string_view ownerOf(std::string_view header) {
  for (const auto& [beginning, library] : kLibraries)
    if (header.starts_with(beginning)) return library;
  if (kPosixHeaders.contains(header)) return "POSIX";
  const std::size_t slash = header.find('/');
  if (slash != std::string_view::npos) {
    const auto rule = kRules.find(header.substr(0, slash));
    return rule != kRules.end() ? rule->first : "unknown";
  }
  return header.find('.') == std::string_view::npos ? "std" : "unknown";
}

bool isHeader(std::string_view file) { return file.ends_with(".h"); }

/// Why `file` ("io/las_reader.cpp") must not include `header`; empty when it may.
std::string objection(std::string_view file, std::string_view header) {
  const std::string_view layer = file.substr(0, file.find('/'));
  const LayerRule& rule = kRules.at(layer);
  const std::string_view owner = ownerOf(header);
  const std::string where = std::string(file) + " includes " + std::string(header) + ": ";
  if (owner == "std")
    return layer == "core" && kNotInCore.contains(header) ? where + "core starts no threads" : std::string();
  if (owner == "GLM" || owner == layer || rule.layers.contains(owner)) return {};
  if (kRules.contains(owner)) return where + std::string(layer) + " must not know " + std::string(owner);
  if (owner == "unknown") return where + "neither a path from the root of the sources nor a known library";
  if (!rule.libraries.contains(owner)) return where + std::string(layer) + " must not use " + std::string(owner);
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

/// Paths from the root of the sources, sorted.
std::vector<std::string> filesIn(const std::vector<std::string_view>& folders, const Names& endings) {
  const fs::path root = STRATA_SOURCE_DIR;
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

TEST(Layers, NoSourceIncludesWhatItsLayerMustNotKnow) {
  const std::vector<std::string> files = filesIn(kLayers, {".h", ".cpp"});
  ASSERT_GT(files.size(), 10u);
  std::size_t includes = 0;
  for (const std::string& file : files)
    for (const std::string& header : includesOf(fs::path(STRATA_SOURCE_DIR) / file)) {
      EXPECT_EQ(objection(file, header), "");
      ++includes;
    }
  EXPECT_GT(includes, files.size()) << "the include lines are not being found";
}

TEST(Layers, ALibraryThatIsHiddenStandsInOneSource) {
  std::map<std::string_view, std::set<std::string>> users;
  for (const std::string& file : filesIn(kLayers, {".cpp"}))
    for (const std::string& header : includesOf(fs::path(STRATA_SOURCE_DIR) / file))
      if (kInOneFile.contains(ownerOf(header))) users[ownerOf(header)].insert(file);
  for (const auto& [library, files] : users)
    EXPECT_EQ(files.size(), 1u) << library << " is included in " << *files.begin() << " and " << *files.rbegin();
}

TEST(Layers, TheCheckRefusesForbiddenIncludes) {
  EXPECT_NE(objection("core/box.h", "io/store.h"), "");
  EXPECT_NE(objection("core/view.cpp", "lz4.h"), "");
  EXPECT_NE(objection("core/log.cpp", "thread"), "");
  EXPECT_NE(objection("io/store.cpp", "lod/select_nodes.h"), "");
  EXPECT_NE(objection("io/store.cpp", "tbb/parallel_for.h"), "");
  EXPECT_NE(objection("lod/streamer.cpp", "render/rasterizer.h"), "");
  EXPECT_NE(objection("lod/streamer.cpp", "GL/gl.h"), "");
  EXPECT_NE(objection("lod/streamer.cpp", "tbb/parallel_for.h"), "");
  EXPECT_NE(objection("render/cpu_rasterizer.cpp", "io/store.h"), "");
  EXPECT_NE(objection("render/cpu_rasterizer.cpp", "lod/streamer.h"), "");
  EXPECT_NE(objection("converter/build.cpp", "lod/select_nodes.h"), "");
  EXPECT_NE(objection("viewer/main.cpp", "converter/convert.h"), "");
  EXPECT_NE(objection("io/las_reader.h", "laszip/laszip_api.h"), "");
  EXPECT_NE(objection("io/las_reader.cpp", "../core/box.h"), "");
  EXPECT_NE(objection("io/las_reader.cpp", "somelib.h"), "");
  EXPECT_NE(objection("io/las_reader.cpp", "boost/optional.hpp"), "");
}

TEST(Layers, TheCheckAllowsWhatTheDesignAllows) {
  EXPECT_EQ(objection("core/box.h", "glm/glm.hpp"), "");
  EXPECT_EQ(objection("core/image.cpp", "png.h"), "");
  EXPECT_EQ(objection("io/las_reader.cpp", "laszip/laszip_api.h"), "");
  EXPECT_EQ(objection("io/byte_source.cpp", "sys/stat.h"), "");
  EXPECT_EQ(objection("lod/streamer.h", "thread"), "");
  EXPECT_EQ(objection("lod/streamer.cpp", "io/node_codec.h"), "");
  EXPECT_EQ(objection("render/gl_context.cpp", "GL/osmesa.h"), "");
  EXPECT_EQ(objection("render/cpu_rasterizer.cpp", "hwy/highway.h"), "");
  EXPECT_EQ(objection("converter/build.cpp", "tbb/parallel_for.h"), "");
  EXPECT_EQ(objection("viewer/main.cpp", "GLFW/glfw3.h"), "");
  EXPECT_EQ(objection("viewer/main.cpp", "lod/streamer.h"), "");
}

TEST(Sources, NoFileIsLongerThanSevenHundredLines) {
  for (const std::string& file : filesIn(kLayersAndTests, {".h", ".cpp", ".glsl", ".comp", ".vert", ".frag"})) {
    std::ifstream in(fs::path(STRATA_SOURCE_DIR) / file);
    int lines = 0;
    for (std::string line; std::getline(in, line);) ++lines;
    EXPECT_LE(lines, kMaxLines) << file;
  }
}

/// The text of the CMakeLists.txt nearest above `file`, and the file's path seen from there.
std::pair<std::string, std::string> nearestList(const fs::path& file) {
  fs::path folder = file.parent_path();
  while (!fs::exists(folder / "CMakeLists.txt")) folder = folder.parent_path();
  std::ifstream in(folder / "CMakeLists.txt");
  return {std::string(std::istreambuf_iterator<char>(in), {}), file.lexically_relative(folder).string()};
}

/// True when `list` names the file, or builds its name in a loop: `fuzz/${name}_fuzz.cpp` with `text` among the names.
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
    const auto [list, name] = nearestList(fs::path(STRATA_SOURCE_DIR) / file);
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

}  // namespace
}  // namespace strata
