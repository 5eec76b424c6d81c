#include "converter/convert_report.h"

#include <algorithm>
#include <filesystem>

#include "io/store/store.h"
#include "io/store/store_files.h"

namespace strata {

void reportStore(const Store& store, ConvertReport& report) {
  report.points = store.info().points;
  report.nodes = store.info().nodes;
  report.skipped = store.info().skipped;
  for (const NodeRecord& node : store.hierarchy().nodes) {
    const auto level = static_cast<std::size_t>(NodeKey{node.key}.level());
    report.nodesByLevel.resize(std::max(report.nodesByLevel.size(), level + 1));
    report.pointsByLevel.resize(report.nodesByLevel.size());
    ++report.nodesByLevel[level];
    report.pointsByLevel[level] += node.pointCount;
  }
  report.planes = planeSizes(store);
  for (const char* file : {kInfoFile, kHierarchyFile, kPointsFile})
    report.outputBytes += std::filesystem::file_size(store.path() + "/" + file);
}

}  // namespace strata
