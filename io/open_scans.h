#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/scan/point_source.h"

namespace strata {

/// Opens every scan that `inputs` name: files, folders (searched recursively, sorted by path) and
/// `synthetic:NAME?points=1e6&seed=1`. The order of the sources is always the same. Throws Error for the first input
/// that is no scan, and Stopped.
///
/// This is the place where a new input format is added: a row of the table `kFormats` in open_scans.cpp names its
/// extension, the bytes such a file begins with, and the function that opens it as a PointSource.
std::vector<std::unique_ptr<PointSource>> openScans(const std::vector<std::string>& inputs,
                                                    const SourceOptions& options);

/// The extension of a path in lower case, with its dot: ".laz". Empty when there is none.
std::string scanExtension(const std::string& path);

}  // namespace strata
