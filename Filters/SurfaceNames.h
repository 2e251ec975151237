// SPDX-License-Identifier: BSD-3-Clause
// Names of the parts of a surface file, which VTK's readers count but do not keep. Only the lines that carry
// names are looked at; the geometry is VTK's business.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pm {

/// A name and the first face it holds for; the next entry ends it.
struct NamedRun {
  std::int64_t firstFace = 0;
  std::string name;
};

struct NamedFaces {
  std::vector<NamedRun> runs;  ///< ascending; faces before the first have no name
  std::int64_t faces = 0;      ///< in the whole file
};

/// Groups ("g") of a Wavefront OBJ file, or its objects ("o") where it has no groups.
NamedFaces scanObjNames(const std::string& path);

/// Names of the solids of an ASCII STL file in order, with empty ones.
std::vector<std::string> scanStlNames(const std::string& path);

}  // namespace pm
