#include "converter/journal/conversion_terms.h"

#include <sys/stat.h>

#include <algorithm>

#include "core/error.h"
#include "core/version.h"

namespace strata {
namespace {

constexpr const char* kStartAgain = "; --force starts the conversion again";

ConversionTerms::Input inputOf(const SourceInfo& info) {
  ConversionTerms::Input input{info.path, info.fileBytes, 0};
  struct stat status {};
  if (::stat(info.path.c_str(), &status) == 0)
    input.changedNs = std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
  return input;
}

}  // namespace

ConversionTerms termsOf(const Sources& sources, const ConvertOptions& options) {
  ConversionTerms terms;
  terms.options = {{"the program", "strata " + version()},
                   {"--memory", std::to_string(options.memoryBytes)},
                   {"--node-points", std::to_string(options.nodePoints)},
                   {"--lod-colour", options.lodColour == LodColour::average ? "average" : "first"},
                   {"--normals", options.normals ? "yes" : "no"},
                   {"--columns", options.source.columns},
                   {"--skip-damaged", options.source.skipDamaged ? "yes" : "no"}};
  for (const auto& source : sources) terms.inputs.push_back(inputOf(source->info()));
  return terms;
}

void checkSameTerms(const std::string& folder, const ConversionTerms& begun, const ConversionTerms& now) {
  for (std::size_t i = 0; i < std::min(begun.options.size(), now.options.size()); ++i)
    if (begun.options[i] != now.options[i])
      throw Error(folder, "the interrupted conversion had another value of " + now.options[i].first + ", found " +
                              now.options[i].second + " (expected " + begun.options[i].second + ")" + kStartAgain);
  for (const ConversionTerms::Input& input : begun.inputs)
    if (std::none_of(now.inputs.begin(), now.inputs.end(), [&](const auto& n) { return n.path == input.path; }))
      throw Error(input.path, std::string("was an input of the interrupted conversion and is none now") + kStartAgain);
  for (std::size_t i = 0; i < now.inputs.size(); ++i) {
    const ConversionTerms::Input& input = now.inputs[i];
    const auto before =
        std::find_if(begun.inputs.begin(), begun.inputs.end(), [&](const auto& b) { return b.path == input.path; });
    if (before == begun.inputs.end())
      throw Error(input.path, std::string("was no input of the interrupted conversion") + kStartAgain);
    if (before->bytes != input.bytes)
      throw Error(input.path, "has changed since the conversion was interrupted, found " + std::to_string(input.bytes) +
                                  " bytes (expected " + std::to_string(before->bytes) + ")" + kStartAgain);
    if (before->changedNs != input.changedNs)
      throw Error(input.path, std::string("has been written to since the conversion was interrupted") + kStartAgain);
    if (begun.inputs[i].path != input.path)
      throw Error(input.path, std::string("has another place among the inputs than before") + kStartAgain);
  }
  if (begun.inputs.size() != now.inputs.size())
    throw Error(folder, "the interrupted conversion had another number of inputs, found " +
                            std::to_string(now.inputs.size()) + " (expected " + std::to_string(begun.inputs.size()) +
                            ")" + kStartAgain);
}

}  // namespace strata
