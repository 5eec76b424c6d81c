// C++ and GLSL both read this file, so that layouts (std430), bindings and uniform locations are written once.
#ifndef STRATA_RENDER_SHADER_TYPES_H
#define STRATA_RENDER_SHADER_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>

namespace strata::shader {
using uint = std::uint32_t;
using vec4 = glm::vec4;
using dvec4 = glm::dvec4;
using ivec4 = glm::ivec4;
using uvec4 = glm::uvec4;
#endif

#define STRATA_MOST_VIEWS 4  // pictures that one pass over the points makes
#define STRATA_MOST_CLIPS 4  // boxes and cutouts together, and as many planes

// Storage blocks of drawing.
#define STRATA_BINDING_PAGE 0         // words of node data
#define STRATA_BINDING_RECORDS 1      // BatchRecord
#define STRATA_BINDING_BATCH_VIEWS 2  // BatchView, one per view for each record
#define STRATA_BINDING_GRIDS 3        // GridRecord
#define STRATA_BINDING_DEPTH 4        // per pixel: bits of the smallest depth; compute64: depth and id in 64 bits
#define STRATA_BINDING_ID 5           // per pixel: the lowest id at that depth
#define STRATA_BINDING_MORE 6         // compute32: candidates; compute_lock: locks; accumulate: sums or counts
#define STRATA_BINDING_COUNTERS 7     // Counters
// Storage blocks of planning, besides page, records and batch views.
#define STRATA_BINDING_PARTS 3  // DrawPart
#define STRATA_BINDING_VIEWS 4  // ViewRecord
#define STRATA_BINDING_RUNS 5   // DispatchRecord

// Storage blocks of progressive drawing, besides grids, depth, id and candidates.
#define STRATA_BINDING_POINTS 0  // PoolPoint: a page of the pool, or what the pixels kept
#define STRATA_BINDING_PIECES 1  // PoolPiece
#define STRATA_BINDING_KEPT 2    // per pixel: the PoolPoint that it shows
// Storage blocks of filling the pool, whose pages are 0 to 3.
#define STRATA_POOL_PAGES 4
#define STRATA_BINDING_PERMUTATION 4  // per index: place in the pool
#define STRATA_BINDING_STAGED 5       // new PoolPoints one after the other; or the points of the pixels
#define STRATA_BINDING_INSERTS 6      // PoolInsert; or PoolPiece

// Storage blocks of filling holes. Steps that never run together share numbers.
#define STRATA_BINDING_FLOOD_PARAMS 0   // FloodParams
#define STRATA_BINDING_FLOOD_SEEDS 1    // FloodSeed, one for each pixel of the half picture
#define STRATA_BINDING_FLOOD_FROM 2     // what a step reads: layers, neighbours, splats or ids
#define STRATA_BINDING_FLOOD_TO 3       // what a step writes
#define STRATA_BINDING_FLOOD_LAYERS 4   // uvec4, one for each pixel of the half picture
#define STRATA_BINDING_FLOOD_REACHES 4  // per tile: bits of the largest reach in it, then of that nearby
#define STRATA_BINDING_FLOOD_ITEMS 5    // FloodItem
#define STRATA_BINDING_FLOOD_NORMALS 2  // projecting: packed normals of the half picture
#define STRATA_BINDING_FLOOD_IDS 6      // ids of the picture
#define STRATA_BINDING_FLOOD_DEPTHS 7   // depths of the picture
#define STRATA_BINDING_FLOOD_LIMITS 3   // drawing: per pixel bits of the depth up to which splats count
#define STRATA_BINDING_FLOOD_COLOURS 4  // drawing: colours of the picture
#define STRATA_BINDING_FLOOD_SUMS 5     // drawing: FloodSum

#define STRATA_UNIFORM_VIEWPORT 0  // per view: half the picture's width and height, width and height of the image
#define STRATA_UNIFORM_LENS 4      // per view: near plane, 1 for perspective or 0, corner of the image in the picture
#define STRATA_UNIFORM_PIXELS 8    // per view: first pixel in the buffers, first row and end row that they hold
#define STRATA_UNIFORM_FIRST_RECORD 12  // record of the first work-group
#define STRATA_UNIFORM_PASS 13          // compute32: 0 is the depth pass, 1 the index pass
#define STRATA_UNIFORM_CLASSES 14       // 8 words of bits: the classes drawn
#define STRATA_UNIFORM_CLIPS 22         // number of clip boxes, planes, cutouts
#define STRATA_UNIFORM_PRECISIONS 23    // colours of 10, 20 and 30 bits instead of the points' own; 0: their own
#define STRATA_UNIFORM_FIRST_PART 24    // planning
#define STRATA_UNIFORM_FORCED 25        // planning: ComputeExperiment::forcedPlanes
#define STRATA_UNIFORM_RANGE 26         // progressive: first point, end, first word of candidates
#define STRATA_UNIFORM_PAGE_POINTS 27   // filling the pool: points per page
#define STRATA_UNIFORM_GRID 28          // progressive: rows of the only grid

#define STRATA_ATTRIBUTE_RECORD 0

#define STRATA_CLIPPED 1     // flag of BatchView: its points must be tested against the clip region
#define STRATA_BOX_WORDS 16  // size of BatchBox

/// One batch to draw.
struct BatchRecord {
  uint firstWord;    // of plane 0 in the page
  uint planeStride;  // words from one plane to the next; a multiple of 4
  uint pointCount;
  uint firstId;
  uint firstClass;      // word of the page with the first point's class in byte firstWord % 4; 0: no classes
  uint firstColour;     // word of the page with the first point's colour; 0: none
  uint firstCandidate;  // word of its candidates
  uint padding;
};

/// How one view sees a batch; see GridMapping.
struct BatchView {
  ivec4 offset;  // w: planes to read, 1 to 3; 0: not seen
  ivec4 shift;   // to the left; to the right where negative. w: index of the grid * 2, + STRATA_CLIPPED
};

/// See GridTransform.
struct GridRecord {
  vec4 x, y, depth;  // xyz: what a step along each axis adds; w: base
  vec4 clipLo[STRATA_MOST_CLIPS], clipHi[STRATA_MOST_CLIPS];
  vec4 clipPlanes[STRATA_MOST_CLIPS];
};

// A PoolPoint is a uvec4. It holds the three words of a position as NodeData has them (0 for planes that are not
// loaded), then the point's index in its piece (12 bits) and the slot of the piece (18 bits). The upper two bits of the
// four words hold the 8 bits of the class, the lowest in the first word.
#define STRATA_PIECE_BITS 12
#define STRATA_SLOT_BITS 18
#define STRATA_NO_POINT 0xffffffffu  // the last word of an empty place; no piece has the last slot

// Flags of PoolPiece.
#define STRATA_PIECE_PLANES 3    // mask: planes to read
#define STRATA_PIECE_CLIPPED 4   // its points must be tested against the clip region
#define STRATA_PIECE_CLASSES 8   // its points have classes
#define STRATA_PIECE_DEAD 16     // freed: its points that are left in the pool must be removed
#define STRATA_PIECE_WRITTEN 32  // written again in this frame, so that pixels fetch its points anew
#define STRATA_PIECE_GRID 8      // the index of the grid lies this many bits to the left of the flags

/// Consecutive points of one batch in the pool, as the view sees them. One per slot.
struct PoolPiece {
  ivec4 offset;  // that of BatchView; w: id of the first point
  uint shifts;   // those of BatchView plus 128, one byte per axis
  uint count;    // how many of its first points are drawn
  uint flags;
  uint first;  // index of the first point, before shuffling
};

/// Points on their way into the pool.
struct PoolInsert {
  uint first;  // index in the pool, before shuffling
  uint count;
  uint staged;  // index of the first in the staging buffer
  uint padding;
};

#define STRATA_FLOOD_TILE 16         // side of the squares that share a largest reach, pixels of the half picture
#define STRATA_FLOOD_WEIGHT 1023.0   // the weight 1 in a FloodSum
#define STRATA_FLOOD_DEPTHS 16384.0  // steps of depth in a FloodSum, from the limit to the eye

// Flags of FloodParams.
#define STRATA_FLOOD_PERSPECTIVE 1
#define STRATA_FLOOD_SECTORS 2
#define STRATA_FLOOD_ESTIMATE 4
#define STRATA_FLOOD_ELLIPSES 8
#define STRATA_FLOOD_KEEP_FRONT 16
#define STRATA_FLOOD_NORMALS 32

/// What FloodSettings and FloodLens say, and the sizes of the pictures.
struct FloodParams {
  int width, height;  // of the picture
  int halfWidth, halfHeight;
  int tileColumns, tileRows;
  uint flags, items;
  float perPixel, middleX, middleY, farthestReach;       // farthestReach: pixels of the half picture
  float angle, continuity, relativeRadius, mostReaches;  // mostReaches: largest radius of close seeds, in reaches
  uint indexBits, padding[3];                            // indexBits: length of an index into the half picture
};

/// One item of the list.
struct FloodItem {
  uint firstId;
  float reach;
};

/// One entry of FloodSeeds. Seeds are searched in a picture of half the width and height.
struct FloodSeed {
  uint pixel;
  float depth, reach;
  uint normal;
};

/// A FloodSplat as it is drawn; radius 0 means that there is none.
struct FloodShape {
  float x, y, tiltX, tiltY;
  float acrossX, acrossY, alongX, alongY;
  float centreDepth, slopeX, slopeY, radius;
  uint columns, rows;  // first | last << 16
  uint open, colour;
};

/// The sums of the splats in one pixel.
struct FloodSum {
  uint red, green, blue, weight;
  uint depth;     // how far before the limit, in steps of STRATA_FLOOD_DEPTHS
  uint heaviest;  // weight << indexBits | (2^indexBits - 1 - the splat's index)
};

/// Counters that the shaders write. They are cleared before each draw.
struct Counters {
  uint pointsDrawn;
  uint batchesDrawn;
  uint batchesCulled;
  uint batchesAt[3];
  uint lockRetries;
  uint lockGivenUp;
};

/// One batch as it lies in a page, in front of the planes of its part.
struct BatchBox {
  uint boxMin[6];   // three doubles, metres from the node's origin
  int step[3];      // grid steps from the corner of the node's first batch
  uint bits;        // one byte per axis
  uint firstPoint;  // within the node
  uint pointCount;
  uint firstCandidate;  // word, counted from the part's first
  uint padding[3];
};

/// A NodePart that plan.comp takes, with what is drawn of it.
struct DrawPart {
  dvec4 origin;                    // NodeData::origin
  dvec4 step;                      // of the grid, metres
  ivec4 first[STRATA_MOST_VIEWS];  // grid steps from E to the node's first corner; w: grid, or -1 where not seen
  uint firstBox, boxCount;         // word of the page; number of batches
  uint firstWord, planeStride;     // of plane 0
  uint firstPoint, prefix;         // within the node: the part's first point, the end of what is drawn
  uint firstId, planes;            // id of the node's first point; planes loaded
  uint firstClass, firstColour;    // words of the part's first point; 0: there are none
  uint firstCandidate, run;
  uint firstRecord, padding[3];  // of the run
};

/// A view as planning needs it, relative to the eye. See ViewConstants.
struct ViewRecord {
  dvec4 planes[5];
  dvec4 eye;
  dvec4 forward;
  dvec4 size;  // pixels per metre at depth 1, corner stretch, near plane, 1 for perspective or 0
  dvec4 clipLo[STRATA_MOST_CLIPS], clipHi[STRATA_MOST_CLIPS];
  dvec4 clipPlanes[STRATA_MOST_CLIPS];
};

/// OpenGL's DispatchIndirectCommand.
struct DispatchRecord {
  uint x, y, z;
};

#ifdef __cplusplus
static_assert(sizeof(BatchRecord) == 32 && sizeof(BatchView) == 32 && sizeof(GridRecord) == 240);
static_assert(sizeof(BatchBox) == 4 * STRATA_BOX_WORDS && sizeof(DrawPart) == 192 && sizeof(ViewRecord) == 640);
static_assert(sizeof(PoolPiece) == 32 && sizeof(PoolInsert) == 16);
static_assert(sizeof(FloodParams) == 80 && sizeof(FloodItem) == 8 && sizeof(FloodSeed) == 16 &&
              sizeof(FloodShape) == 64);
static_assert(sizeof(FloodSum) == 24);
static_assert(sizeof(DispatchRecord) == 12 && sizeof(Counters) == 32);
}  // namespace strata::shader
#endif
#endif
