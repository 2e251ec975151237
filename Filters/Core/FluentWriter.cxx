// SPDX-License-Identifier: BSD-3-Clause
#include "FluentWriter.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <numeric>

#include "FoamWriter.h"
#include "OutputFile.h"

namespace pm {
namespace {

constexpr const char* kCaption = "writing the Fluent mesh";
constexpr int kInterior = 2, kWall = 3, kPressureOutlet = 5, kPressureFarField = 9, kVelocityInlet = 10;
constexpr Id kNodeZone = 1;  // zones of cells and then of faces follow it

/// Zones of cells or of faces, and their members in the order of the file.
struct Members {
  std::vector<Id> items;
  std::vector<Id> start;  // of each zone, and the end
};

/// Items in groups by key, those of one key in their order.
template <class Key>
Members groupBy(Id items, Id keys, const Key& keyOf) {
  Members out;
  out.start.assign(keys + 1, 0);
  for (Id i = 0; i < items; ++i) ++out.start[keyOf(i) + 1];
  std::partial_sum(out.start.begin(), out.start.end(), out.start.begin());
  out.items.resize(items);
  std::vector<Id> next(out.start.begin(), out.start.end() - 1);
  for (Id i = 0; i < items; ++i) out.items[next[keyOf(i)]++] = i;
  return out;
}

/// The mesh as the file sees it. The zones of faces are, for each zone z of cells, its interior (key z) and
/// what each patch p has of it (key (p + 1) * zones + z).
struct Layout {
  Id zones = 1;
  Members cells, faces;
  std::vector<Id> cellId;             // in the file, of each cell of the mesh
  std::vector<std::string> cellName;  // of each zone of cells
  std::vector<std::string> faceName;  // of each zone of faces; those without faces are not written

  Id zoneOf(const PolyMesh& mesh, Id cell) const { return zones > 1 ? mesh.zone[cell] : 0; }
};

void nameZones(const PolyMesh& mesh, Layout& layout) {
  const Id zones = layout.zones, keys = static_cast<Id>(layout.faces.start.size()) - 1;
  const auto hasFaces = [&](Id key) { return layout.faces.start[key] < layout.faces.start[key + 1]; };
  layout.cellName = zones > 1 ? mesh.zoneNames : std::vector<std::string>{"fluid"};
  layout.faceName.resize(keys);
  for (Id z = 0; z < zones; ++z) layout.faceName[z] = "interior-" + layout.cellName[z];
  // In one list: no two zones of a file may share a name, and a patch keeps its own when others need a
  // number.
  std::vector<std::string*> named;
  for (Id patch = 0; patch < static_cast<Id>(mesh.patchNames.size()); ++patch) {
    const Id first = (patch + 1) * zones;
    Id touched = 0;
    for (Id key = first; key < first + zones; ++key) touched += hasFaces(key);
    for (Id z = 0; z < zones; ++z) {
      std::string& name = layout.faceName[first + z];
      name = mesh.patchNames[patch];
      if (touched > 1) name += "-" + layout.cellName[z];
      if (hasFaces(first + z)) named.push_back(&name);
    }
  }
  for (std::string& name : layout.cellName) named.push_back(&name);
  for (Id z = 0; z < zones; ++z) named.push_back(&layout.faceName[z]);

  std::vector<std::string> names;
  for (const std::string* name : named) names.push_back(*name);
  names = foamPatchNames(names);
  for (std::size_t i = 0; i < named.size(); ++i) *named[i] = names[i];
}

Layout layOut(const PolyMesh& mesh) {
  Layout layout;
  layout.zones = std::max<Id>(1, static_cast<Id>(mesh.zoneNames.size()));
  layout.cells = groupBy(mesh.cellCount, layout.zones, [&](Id c) { return layout.zoneOf(mesh, c); });
  layout.cellId.resize(mesh.cellCount);
  for (Id i = 0; i < mesh.cellCount; ++i) layout.cellId[layout.cells.items[i]] = i + 1;
  const Id keys = layout.zones * (static_cast<Id>(mesh.patchNames.size()) + 1),
           internal = mesh.internalFaces();
  layout.faces = groupBy(mesh.faceCount(), keys, [&](Id f) {
    const Id group = f < internal ? 0 : mesh.patch[f - internal] + 1;
    return group * layout.zones + layout.zoneOf(mesh, mesh.owner[f]);
  });
  nameZones(mesh, layout);
  return layout;
}

/// The file, and whether the bodies of its sections are binary: then their index has 30 in front.
struct FluentFile : OutputFile {
  FluentFile(const std::string& path, bool isBinary) : OutputFile(path), binary(isBinary) {}

  void beginSection(int index, const std::string& header) {
    section = (binary ? 3000 : 0) + index;
    text(fmt::format("({} ({})({}", section, header, binary ? "" : "\n"));
  }
  void endSection() {
    text(binary ? fmt::format(")\nEnd of Binary Section   {})\n", section) : std::string("))\n"));
  }
  const bool binary;
  int section = 0;
};

void writeHeader(FluentFile& file, const PolyMesh& mesh) {
  file.text("(1 \"ProjectionMesher\")\n(2 3)\n");
  if (file.binary) file.text("(4 (60 0 0 1 2 4 4 4 8 4 4))\n");  // little-endian, IEEE numbers
  file.text("(0 \"Totals of nodes, cells and faces\")\n");
  file.text(fmt::format("(10 (0 1 {:x} 0 3))\n(12 (0 1 {:x} 0))\n(13 (0 1 {:x} 0))\n", mesh.points.size(),
                        mesh.cellCount, mesh.faceCount()));
}

void writeNodes(FluentFile& file, const PolyMesh& mesh, Monitor& monitor) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");
  file.text("(0 \"Nodes\")\n");
  file.beginSection(10, fmt::format("{:x} 1 {:x} 1 3", kNodeZone, mesh.points.size()));
  if (file.binary) {
    file.bytes(mesh.points.data(), mesh.points.size() * sizeof(Vec3));
  } else {
    writeItems(file, static_cast<Id>(mesh.points.size()), monitor, kCaption, [&](Id i, TextBuffer& out) {
      const Vec3& p = mesh.points[i];
      fmt::format_to(std::back_inserter(out), "{} {} {}\n", p.x(), p.y(), p.z());
    });
  }
  file.endSection();
}

/// Types of the cells in the order of the file.
std::vector<FluentCell> cellTypes(const PolyMesh& mesh, const Layout& layout) {
  const Csr<Id> facesOf = cellFaces(mesh);
  std::vector<FluentCell> types(mesh.cellCount);
  tbb::parallel_for(Id(0), mesh.cellCount,
                    [&](Id i) { types[i] = fluentCell(mesh, facesOf[layout.cells.items[i]]); });
  return types;
}

void writeCells(FluentFile& file, const PolyMesh& mesh, const Layout& layout, Monitor& monitor) {
  constexpr int kActive = 1;
  const std::vector<FluentCell> types = cellTypes(mesh, layout);
  file.text("(0 \"Cells\")\n");
  for (Id zone = 0; zone < layout.zones; ++zone) {
    const Id first = layout.cells.start[zone], last = layout.cells.start[zone + 1];
    if (first == last) continue;
    const auto begin = types.begin() + first, end = types.begin() + last;
    const bool alike = std::all_of(begin, end, [&](FluentCell type) { return type == *begin; });
    const std::string header = fmt::format("{:x} {:x} {:x} {} {}", kNodeZone + 1 + zone, first + 1, last,
                                           kActive, alike ? static_cast<int>(*begin) : 0);
    if (alike) {
      file.text(fmt::format("(12 ({}))\n", header));
      continue;
    }
    file.beginSection(12, header);
    writeItems(file, last - first, monitor, kCaption, [&](Id i, TextBuffer& out) {
      const std::int32_t type = static_cast<std::int32_t>(begin[i]);
      if (file.binary) return appendRaw(out, type);
      out.push_back(static_cast<char>('0' + type));
      out.push_back(i % 40 == 39 ? '\n' : ' ');
    });
    file.endSection();
  }
}

/// Fluent's element type of a run of faces.
int faceType(const PolyMesh& mesh, const Id* begin, const Id* end) {
  bool triangles = true, quads = true, either = true;
  for (const Id* f = begin; f != end; ++f) {
    const std::size_t corners = mesh.faces[*f].size();
    triangles = triangles && corners == 3;
    quads = quads && corners == 4;
    either = either && corners <= 4;
  }
  return triangles ? 3 : quads ? 4 : either ? 0 : 5;
}

/// A face's numbers: how many points where the type does not say, the points, its two cells. Points are
/// turned around: the mesh's normal leaves the owner, Fluent's enters it.
template <class Put>
void forNumbers(const PolyMesh& mesh, const Layout& layout, Id face, bool counted, const Put& put) {
  const Span<Id> row = mesh.faces[face];
  if (counted) put(static_cast<Id>(row.size()));
  for (const Id* p = row.end(); p != row.begin();) put(*--p + 1);
  put(layout.cellId[mesh.owner[face]]);
  put(face < mesh.internalFaces() ? layout.cellId[mesh.neighbour[face]] : 0);
}

void writeFaceZone(FluentFile& file, const PolyMesh& mesh, const Layout& layout, Id key,
                   const std::string& head, Monitor& monitor) {
  const Id first = layout.faces.start[key], last = layout.faces.start[key + 1];
  const Id* begin = layout.faces.items.data() + first;
  const int type = faceType(mesh, begin, begin + (last - first));
  const bool counted = type == 0 || type == 5;
  file.beginSection(13, fmt::format("{} {}", head, type));
  writeItems(file, last - first, monitor, kCaption, [&](Id i, TextBuffer& out) {
    if (file.binary) {
      forNumbers(mesh, layout, begin[i], counted, [&](Id number) { appendRaw(out, number); });
    } else {
      const auto put = [&](Id number) { fmt::format_to(std::back_inserter(out), "{:x} ", number); };
      forNumbers(mesh, layout, begin[i], counted, put);
      out[out.size() - 1] = '\n';
    }
  });
  file.endSection();
}

/// Sections of faces, then those that name the zones.
void writeFacesAndNames(FluentFile& file, const PolyMesh& mesh, const Layout& layout, Monitor& monitor) {
  file.text("(0 \"Faces\")\n");
  std::string names = "(0 \"Zones\")\n";
  Id id = kNodeZone;  // decimal in the sections of names, hexadecimal elsewhere
  for (const std::string& name : layout.cellName) names += fmt::format("(45 ({} fluid {})())\n", ++id, name);
  for (Id key = 0; key + 1 < static_cast<Id>(layout.faces.start.size()); ++key) {
    const Id first = layout.faces.start[key], last = layout.faces.start[key + 1];
    if (first == last) continue;
    const FluentBoundary boundary = key < layout.zones ? FluentBoundary{kInterior, "interior"}
                                                       : fluentBoundary(mesh, key / layout.zones - 1);
    names += fmt::format("(45 ({} {} {})())\n", ++id, boundary.word, layout.faceName[key]);
    const double all = mesh.faceCount();
    PartMonitor part(monitor, first / all, last / all);
    writeFaceZone(file, mesh, layout, key,
                  fmt::format("{:x} {:x} {:x} {:x}", id, first + 1, last, boundary.type), part);
  }
  file.text(names);
}

}  // namespace

FluentCell fluentCell(const PolyMesh& mesh, Span<Id> faces) {
  struct Shape {
    std::size_t triangles, quads, corners;
    FluentCell type;
  };
  constexpr Shape shapes[] = {{4, 0, 4, FluentCell::Tetrahedron},
                              {4, 1, 5, FluentCell::Pyramid},
                              {2, 3, 6, FluentCell::Wedge},
                              {0, 6, 8, FluentCell::Hexahedron}};
  std::array<Id, 24> corner{};  // of all faces: six quads at most
  std::size_t triangles = 0, quads = 0, count = 0;
  for (Id face : faces) {
    const Span<Id> row = mesh.faces[face];
    if (row.size() > 4 || count + row.size() > corner.size()) return FluentCell::Polyhedron;
    ++(row.size() == 3 ? triangles : quads);
    count =
        static_cast<std::size_t>(std::copy(row.begin(), row.end(), corner.begin() + count) - corner.begin());
  }
  std::sort(corner.begin(), corner.begin() + count);
  std::size_t corners = 0, ofThree = 0;  // different points, and those of exactly three faces
  for (std::size_t i = 0, next = 0; i < count; i = next) {
    while (next < count && corner[next] == corner[i]) ++next;
    ++corners;
    ofThree += next - i == 3;
  }
  for (const Shape& s : shapes) {
    const std::size_t plain = s.type == FluentCell::Pyramid ? s.corners - 1 : s.corners;
    if (triangles == s.triangles && quads == s.quads && corners == s.corners && ofThree == plain)
      return s.type;
  }
  return FluentCell::Polyhedron;
}

FluentBoundary fluentBoundary(const PolyMesh& mesh, Id patchId) {
  if (foamPatchType(mesh, patchId) == "wall") return {kWall, "wall"};
  std::string name = mesh.patchNames[patchId];
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto has = [&](const char* word) { return name.find(word) != std::string::npos; };
  if (has("inlet") || has("inflow")) return {kVelocityInlet, "velocity-inlet"};
  if (has("farfield") || name == "far") return {kPressureFarField, "pressure-far-field"};
  return {kPressureOutlet, "pressure-outlet"};
}

void writeFluent(const PolyMesh& mesh, const std::string& path, bool binary, Monitor& monitor) {
  const Layout layout = layOut(mesh);
  PartMonitor nodes(monitor, 0, 0.2), cells(monitor, 0.2, 0.4), faces(monitor, 0.4, 1);
  FluentFile file(path, binary);
  nodes.check(0, kCaption);
  writeHeader(file, mesh);
  writeNodes(file, mesh, nodes);
  cells.check(0, kCaption);
  writeCells(file, mesh, layout, cells);
  writeFacesAndNames(file, mesh, layout, faces);
  monitor.check(1, kCaption);
  file.close();
  file.publish();
}

}  // namespace pm
