// Runs the fuzz target that it is linked with over files and folders, with any compiler and without libFuzzer.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  std::vector<fs::path> inputs;
  for (int i = 1; i < argc; ++i) {
    if (!fs::is_directory(argv[i])) {
      inputs.emplace_back(argv[i]);
      continue;
    }
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(argv[i]))
      if (entry.is_regular_file()) inputs.push_back(entry.path());
  }
  std::sort(inputs.begin(), inputs.end());
  std::size_t runs = 0;
  for (const fs::path& input : inputs) {
    std::ifstream file(input, std::ios::binary);
    if (!file) {
      std::fprintf(stderr, "error: %s: cannot be read\n", input.c_str());
      return 1;
    }
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    std::fprintf(stderr, "%s\n", input.c_str());  // the last line before a crash names its input
    // Every prefix is an input too, in steps that keep the number of runs small. Each has a buffer of exactly its size,
    // so that AddressSanitizer sees the first byte behind it.
    const std::size_t step = bytes.size() / 200 + 1;
    for (std::size_t size = bytes.size() % step; size <= bytes.size(); size += step) {
      const std::vector<std::uint8_t> prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      LLVMFuzzerTestOneInput(prefix.data(), prefix.size());
      ++runs;
    }
  }
  std::printf("%zu inputs, %zu runs with their prefixes\n", inputs.size(), runs);
  return inputs.empty() ? 1 : 0;
}
