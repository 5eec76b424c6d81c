#pragma once
#include "converter/control.h"
#include "converter/convert_report.h"
#include "converter/options.h"

namespace strata {

/// Converts the inputs to a store, in these stages:
///
///  1. survey       reads headers and decides grid, cube and attributes. "measure" first reads the points of sources
///                  whose headers do not say where they lie.
///  2. distribute   reads every point once and writes it, with about a million others sorted by cell, to the spill as
///                  one run. Cells with too many points for memory are split. In memory: one run per thread.
///  3. build        builds each chunk, a cell whose points fit in memory, into nodes, top down. In memory: the points
///                  of at most four of the largest chunks.
///  4. merge        builds the nodes above the chunks, bottom up. In memory: a few chunks' top nodes.
///  5. normals      writes all nodes once more, with an estimated normal for every point; only where asked for.
///  6. write        writes store.json and hierarchy.bin, flushes everything and gives the store its final name.
///
/// The journal remembers each finished piece of work. A conversion that is killed at any moment leaves its building
/// folder behind, and `options.resume` goes on from the last finished piece, to the same bytes. Nothing carries the
/// final name before it is complete and durable. An Error removes what was begun; Stopped keeps it for
/// `options.resume`, and so does a finished store whose name is taken. The same inputs and options give the same bytes
/// for any number of threads. Throws Error.
ConvertReport convert(const ConvertOptions& options, const ConvertControl& control);
/// Converts scans that are open already and ignores `options.inputs`.
ConvertReport convert(const Sources& sources, const ConvertOptions& options, const ConvertControl& control);

}  // namespace strata
