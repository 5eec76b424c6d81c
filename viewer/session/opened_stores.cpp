#include "viewer/session/opened_stores.h"

#include <filesystem>
#include <utility>

#include "core/error.h"
#include "viewer/tools/clip_boxes.h"

namespace strata {

OpenedStores openStores(const std::vector<std::string>& paths) {
  OpenedStores opened;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    try {
      opened.stores.push_back(std::make_shared<const Store>(paths[i]));
      opened.asked.push_back(i);
    } catch (const Error& error) {
      if (opened.stores.empty() && i + 1 == paths.size()) throw;
      if (!opened.failures.empty()) opened.failures += '\n';
      opened.failures += error.what();
    }
  }
  return opened;
}

ScanSample sampleStores(const std::vector<std::shared_ptr<const Store>>& stores) {
  std::vector<glm::dvec3> points;
  for (const auto& store : stores) {
    try {
      const ScanSample scan = sampleStore(*store);
      points.insert(points.end(), scan.points.begin(), scan.points.end());
    } catch (const Error&) {  // the streamer says which nodes are damaged
      for (const auto& [a, b] : edgesOf(store->info().bounds)) points.insert(points.end(), {a, b});
    }
  }
  return makeScanSample(std::move(points));
}

std::string layerNames(const std::vector<std::string>& paths) {
  std::string names;
  for (const std::string& path : paths) {
    const std::filesystem::path folder(path.back() == '/' ? path.substr(0, path.size() - 1) : path);
    names += (names.empty() ? "" : ", ") + folder.stem().string();
  }
  return names;
}

std::string fileNameOf(std::string name) {
  for (char& c : name)
    if (c == '/' || c == '\\' || static_cast<unsigned char>(c) < 32) c = '_';
  return name.empty() || name.front() == '.' ? "_" + name : name;
}

}  // namespace strata
