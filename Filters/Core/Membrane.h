// SPDX-License-Identifier: BSD-3-Clause
// The skin between inside and outside: one smooth membrane in each hole, its rim on the geometry.
//
// Where two free leaves of different sides share a face the skin passes. These faces, connected by common
// corners, are the membranes; one membrane is one hole. A membrane relaxes like a soap film: points within go
// to the middle of their neighbours, points of the rim likewise, but back onto the closest geometry each
// time. So the rim slides to where the passage is narrowest, which is the open edge where there is one, and
// lies on the geometry exactly.
//
// Every way from inside to outside crosses the membrane. So twice the largest clearance on it bounds the
// width of the widest way from above, whatever the leaves were: this is the hole's width.
#pragma once

#include <array>
#include <vector>

#include "Monitor.h"
#include "Octree.h"
#include "SurfaceModel.h"
#include "Watershed.h"

namespace pm {

struct Membrane {
  std::vector<Vec3> points;                  ///< #P
  std::vector<std::array<Id, 3>> triangles;  ///< #T rows of points; normals point outside
  std::vector<std::array<Id, 2>> leafPairs;  ///< free leaves (inside, outside) that meet at the skin
  std::vector<std::uint8_t> onRim;           ///< #P 1 = the point lies on the geometry
  Vec3 bottleneck = Vec3::Zero();            ///< place of the largest clearance
  double width = 0;                          ///< twice that clearance, length
  double area = 0;
  std::array<Id, 2> crossing{kNone, kNone};  ///< the leaves nearest to the bottleneck
};

/// Each triangle as four; edges that two triangles share stay shared.
void quarter(std::vector<Vec3>& points, std::vector<std::array<Id, 3>>& triangles);

/// Like a soap film: each point goes to the middle of its neighbours; points of the rim likewise, then onto
/// the closest geometry, but no farther than `slide` from where they met it first. held: #P 1 = of the rim
/// though the membrane goes on beyond; none when empty.
void relax(Membrane& m, const SurfaceModel& model, double slide, Monitor& monitor,
           const std::vector<std::uint8_t>& held = {});

struct RimFilms;

/// Membranes between the sides, in the order of their first leaf. One that follows a film of the rims (they
/// may be null) is that film.
std::vector<Membrane> membranesBetween(const Octree& tree, const SurfaceModel& model,
                                       const std::vector<double>& clearance, const Csr<Id>& graph,
                                       const std::vector<Side>& sides, const RimFilms* rims,
                                       Monitor& monitor);

}  // namespace pm
