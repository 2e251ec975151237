// SPDX-License-Identifier: BSD-3-Clause
// Where a geometry has holes: ways from inside to outside through free leaves, ranked by width
// (thesis 3.6.3).
//
// The thesis follows a shortest way between two given points. Here inside and outside may also be found,
// every hole of a room is found at once (one membrane each, see Membrane.h), and a way keeps to the middle of
// its passage.
//
// Sealing: a way through free leaves of edge h keeps h/2 away from the geometry, and no way crosses a
// membrane farther from it than half the width; so leaves larger than the width cannot pass. That is certain;
// clearly smaller leaves (a third of the width) do pass.
#pragma once

#include <string>
#include <vector>

#include "Membrane.h"

namespace pm {

/// How the root cells were chosen; tells what the smallest leaf of another feature size will be.
enum class RootCells : std::uint8_t {
  Unknown,     ///< nothing is known but the brick
  FromFeature  ///< base size 0 and no domain: the smallest leaf is the feature size
};

struct LeakOptions {
  std::vector<Vec3> insidePoints;   ///< in rooms meant to be inside; none = rooms are found
  std::vector<Vec3> outsidePoints;  ///< none = the corners of the domain
  std::vector<Id> outsideLeaves;    ///< free leaves known to be outside, in place of points or corners
  double roominess =
      2;  ///< found rooms: clearance in the room over clearance of its widest way out, at least
  double smallestRoom = 1e-4;  ///< found rooms: volume over that of the geometry's box, at least
  bool wideOpenings = false;   ///< where no room is found: rooms whose opening is as wide as themselves
  int maximumLeaks = 100;      ///< the widest are kept; 0 = all
  RootCells roots = RootCells::Unknown;
};

struct Leak {
  double width = 0;        ///< of the narrowest place of the widest way through this hole, length
  double sealingSize = 0;  ///< a feature size that closes this hole, length
  Vec3 bottleneck = Vec3::Zero();
  std::vector<Vec3> path;      ///< from inside to outside; no segment touches the geometry
  std::vector<double> widths;  ///< #path twice the clearance, length
  Id bottleneckRow = 0;        ///< row of the path at the bottleneck
  bool wide = false;  ///< about as wide as the room it leads to, and no inside point tells what it is
  Membrane membrane;
};

/// One room and the holes it leaks through together.
struct LeakSearch {
  std::vector<Leak> leaks;      ///< widest first
  std::vector<Pocket> pockets;  ///< rooms the leaks lead out of; those of given points first
  std::vector<Side> sides;      ///< #L
};

/// A leak that stops a stage: the sentence names place, width and remedy of the widest, `leaks` holds all.
struct LeakError : RegionError {
  LeakError(const std::string& sentence, std::vector<Leak> found)
      : RegionError(sentence), leaks(std::move(found)) {}
  std::vector<Leak> leaks;
};

/// Empty leaks when the octree does not leak. Throws RegionError for a point in no free leaf, InputError for
/// a point given as both inside and outside.
LeakSearch findLeaks(const Octree& tree, const SurfaceModel& model, const LeakOptions& options,
                     Monitor& monitor);

/// Feature size for which no leaf passes a hole of this width.
double sealingSize(double width, const Brick& brick, RootCells roots);

/// "The widest leak is at (1, 2, 3), 0.02 wide; a feature size of 0.021 seals it. ..." Empty without leaks.
std::string describe(const std::vector<Leak>& leaks);

/// Throws what is known of a leak: LeakError with the sentence and what describe() adds, or, when no path is
/// found, RegionError with the sentence alone. The points are those of LeakOptions.
[[noreturn]] void throwLeak(const std::string& sentence, const Octree& tree, const SurfaceModel& model,
                            const std::vector<Vec3>& insidePoints, const std::vector<Vec3>& outsidePoints,
                            Monitor& monitor);

/// A warning when the enclosed region of this volume looks like a cavity beside a room that leaks: it fills
/// little of the geometry's box, and a room behind a narrow opening is more than twice as large; or, without
/// such a room, when it fills less than a thousandth of the box.
void warnOfLargerRoom(double volume, const Octree& tree, const SurfaceModel& model, Monitor& monitor);

}  // namespace pm
