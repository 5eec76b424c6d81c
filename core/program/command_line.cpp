#include "core/program/command_line.h"

#include <CLI/CLI.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iostream>

#include "core/error.h"

namespace strata {

bool parseCommandLine(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    app.exit(asked, std::cout, std::cerr);
    return false;
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return true;
}

std::uint64_t parseBytes(const std::string& option, const std::string& text) {
  double value = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(end, text.data() + text.size());
  for (char& c : unit) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (unit.size() > 1 && unit.back() == 'B') unit.pop_back();
  if (unit.size() > 1 && unit.back() == 'I') unit.pop_back();
  const std::string units = "KMGT";
  const std::size_t power = unit.empty() || unit == "B" ? 0 : unit.size() == 1 ? units.find(unit[0]) + 1 : 0;
  const bool known = unit.empty() || unit == "B" || power > 0;
  const double bytes = std::ldexp(value, static_cast<int>(power) * 10);
  if (failure != std::errc() || !known || !(bytes >= 0.0) || bytes > 9e18)
    throw UsageError(option, "found '" + text + "' (expected a size such as 512M or 2G)");
  return static_cast<std::uint64_t>(bytes);
}

}  // namespace strata
