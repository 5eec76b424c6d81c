#pragma once
#include <string>

#include "io/store/store.h"

namespace strata {

/// Asks the system to forget what it holds of a file in memory, so that the next reads come from the disk, and
/// returns the share of the file that is held nevertheless (0 to 1). Throws Error when the file cannot be opened.
double dropFromPageCache(const std::string& path);

/// The share of a file that is held in memory (0 to 1). Throws Error when the file cannot be opened.
double shareInPageCache(const std::string& path);

/// Drops the store's points from the page cache and says for the report how far that went.
std::string dropPages(const Store& store);
/// Says for the report how much of the store's points is in the page cache.
std::string pagesAsTheyAre(const Store& store);

}  // namespace strata
