// SPDX-License-Identifier: BSD-3-Clause
// Openings about as wide as the room they lead to: soap films over the closed loops of open edges.
//
// A narrow hole shows in the clearance alone. A cube without one side does not: its opening is as wide as the
// room. But where a surface ends, its open edges run around the opening. Each closed loop of them is spanned
// by a film, and a leaf near a film counts as narrow as if the film were geometry; so the search that finds
// narrow holes stops at films too. Films only guide: what is no membrane between inside and outside is
// forgotten, however many loops dirty geometry has.
#pragma once

#include <memory>
#include <vector>

#include "Membrane.h"

namespace pm {

struct RimFilms {
  std::vector<Membrane> films;            ///< one a loop; points and triangles only
  std::unique_ptr<SurfaceModel> surface;  ///< all of them, patch = row of films; null without films
};

/// Films over the loops that cells can pass: those longer than four cells. cell: edge of the smallest leaf
/// and about that of a film's triangles.
RimFilms spanRims(const SurfaceModel& model, double cell, Monitor& monitor);

/// #L clearance as if the films were geometry: below the clearance of any leaf away from them where a leaf
/// touches a film, so that films are passed last. Negative for cut leaves as before. Parallel.
std::vector<double> guidedClearance(const Octree& tree, const std::vector<double>& clearance,
                                    const RimFilms& rims);

}  // namespace pm
