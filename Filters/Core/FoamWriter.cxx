// SPDX-License-Identifier: BSD-3-Clause
#include "FoamWriter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <memory>
#include <numeric>
#include <unordered_set>

#include "OutputFile.h"

namespace pm {
namespace {

namespace fs = std::filesystem;
constexpr const char* kCaption = "writing the polyMesh folder";

/// One file of the folder.
class FoamFile : public OutputFile {
 public:
  FoamFile(const fs::path& directory, const std::string& object)
      : OutputFile((directory / object).string()), object_(object) {}

  void header(const char* foamClass, bool binary, const std::string& note = {}) {
    text(fmt::format("FoamFile\n{{\n    version     2.0;\n    format      {};\n    class       {};\n",
                     binary ? "binary" : "ascii", foamClass));
    if (!note.empty()) text(fmt::format("    note        \"{}\";\n", note));
    text("    arch        \"LSB;label=32;scalar=64\";\n    location    \"constant/polyMesh\";\n");
    text(fmt::format("    object      {};\n}}\n\n", object_));
  }
  template <class T>
  void binaryList(const std::vector<T>& values) {
    text(fmt::format("{}\n(", values.size()));
    bytes(values.data(), values.size() * sizeof(T));
    text(")\n");
  }

 private:
  std::string object_;
};

/// Writes "count ( ... )" where format(i, buffer) appends line i.
template <class Format>
void asciiList(FoamFile& file, Id count, Monitor& monitor, double fraction, const Format& format) {
  PartMonitor part(monitor, fraction, fraction);
  file.text(fmt::format("{}\n(\n", count));
  writeItems(file, count, part, kCaption, format);
  file.text(")\n");
}

void append(TextBuffer& out, Id value) {
  const fmt::format_int text(value);
  out.append(text.data(), text.data() + text.size());
}

void labelList(FoamFile& file, const std::vector<Id>& values, bool binary, Monitor& monitor,
               double fraction) {
  if (binary) return file.binaryList(values);
  asciiList(file, static_cast<Id>(values.size()), monitor, fraction, [&](Id i, TextBuffer& out) {
    append(out, values[i]);
    out.push_back('\n');
  });
}

/// Faces in OpenFOAM's order: the internal ones, then each patch's.
struct FaceOrder {
  std::vector<Id> faces;
  std::vector<Id> patchStart;  // of each patch, and the end
};

FaceOrder orderByPatch(const PolyMesh& mesh) {
  FaceOrder order;
  const Id internal = mesh.internalFaces();
  order.patchStart.assign(mesh.patchNames.size() + 1, 0);
  order.patchStart[0] = internal;
  for (Id patch : mesh.patch) ++order.patchStart[patch + 1];
  std::partial_sum(order.patchStart.begin(), order.patchStart.end(), order.patchStart.begin());
  order.faces.resize(mesh.faceCount());
  std::iota(order.faces.begin(), order.faces.begin() + internal, 0);
  std::vector<Id> next(order.patchStart.begin(), order.patchStart.end() - 1);
  for (Id i = 0; i < mesh.boundaryFaces(); ++i) order.faces[next[mesh.patch[i]]++] = internal + i;
  return order;
}

void writePoints(const PolyMesh& mesh, FoamFile& file, bool binary, Monitor& monitor) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");
  file.header("vectorField", binary);
  if (binary) return file.binaryList(mesh.points);
  asciiList(file, static_cast<Id>(mesh.points.size()), monitor, 0.1, [&](Id i, TextBuffer& out) {
    const Vec3& p = mesh.points[i];
    fmt::format_to(std::back_inserter(out), "({} {} {})\n", p.x(), p.y(), p.z());
  });
}

void writeFaces(const PolyMesh& mesh, const FaceOrder& order, FoamFile& file, bool binary, Monitor& monitor) {
  file.header(binary ? "faceCompactList" : "faceList", binary);
  if (!binary) {
    asciiList(file, mesh.faceCount(), monitor, 0.5, [&](Id i, TextBuffer& out) {
      const Span<Id> row = mesh.faces[order.faces[i]];
      append(out, static_cast<Id>(row.size()));
      char separator = '(';
      for (Id p : row) {
        out.push_back(separator);
        append(out, p);
        separator = ' ';
      }
      out.append(fmt::string_view(")\n"));
    });
    return;
  }
  Csr<Id> rows;
  rows.offsets.reserve(mesh.faces.offsets.size());
  rows.values.reserve(mesh.faces.values.size());
  for (Id f : order.faces) rows.push(mesh.faces[f]);
  file.binaryList(rows.offsets);
  file.text("\n");
  file.binaryList(rows.values);
}

void writeBoundary(const PolyMesh& mesh, const FaceOrder& order, FoamFile& file) {
  const std::vector<std::string> names = foamPatchNames(mesh.patchNames);
  std::string entries;
  int count = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Id start = order.patchStart[i], faces = order.patchStart[i + 1] - start;
    if (faces == 0) continue;
    ++count;
    entries += fmt::format(
        "    {}\n    {{\n        type            {};\n        nFaces          {};\n"
        "        startFace       {};\n    }}\n",
        names[i], foamPatchType(mesh, static_cast<Id>(i)), faces, start);
  }
  file.header("polyBoundaryMesh", false);
  file.text(fmt::format("{}\n(\n{})\n", count, entries));
}

/// Cells of each zone, ascending.
Csr<Id> cellsOfZones(const PolyMesh& mesh) {
  Csr<Id> cells;
  cells.offsets.assign(mesh.zoneNames.size() + 1, 0);
  for (Id zone : mesh.zone) ++cells.offsets[zone + 1];
  std::partial_sum(cells.offsets.begin(), cells.offsets.end(), cells.offsets.begin());
  cells.values.resize(mesh.zone.size());
  std::vector<Id> next(cells.offsets.begin(), cells.offsets.end() - 1);
  for (Id c = 0; c < static_cast<Id>(mesh.zone.size()); ++c) cells.values[next[mesh.zone[c]]++] = c;
  return cells;
}

void writeCellZones(const PolyMesh& mesh, FoamFile& file, bool binary, Monitor& monitor) {
  const std::vector<std::string> names = foamPatchNames(mesh.zoneNames);
  const Csr<Id> cells = cellsOfZones(mesh);
  file.header("regIOobject", binary);
  file.text(fmt::format("{}\n(\n", names.size()));
  for (Id zone = 0; zone < cells.rows(); ++zone) {
    const Span<Id> row = cells[zone];
    file.text(
        fmt::format("{}\n{{\n    type            cellZone;\n    cellLabels      List<label> ", names[zone]));
    labelList(file, std::vector<Id>(row.begin(), row.end()), binary, monitor, 0.95);
    file.text(";\n}\n");
  }
  file.text(")\n");
}

/// What OpenFOAM would read beside the new files although it belongs to a former mesh.
void removeStale(const fs::path& directory, bool hasZones) {
  std::error_code ignored;
  for (const char* name : {"points", "faces", "owner", "neighbour", "boundary"}) {
    fs::remove(directory / (std::string(name) + ".gz"), ignored);
  }
  for (const char* name :
       {"cellZones", "faceZones", "pointZones", "meshModifiers", "parallelData", "cells"}) {
    if (!hasZones || std::strcmp(name, "cellZones") != 0) fs::remove(directory / name, ignored);
    fs::remove(directory / (std::string(name) + ".gz"), ignored);
  }
}

}  // namespace

std::string foamPatchType(const PolyMesh& mesh, Id patchId) {
  if (!mesh.isWallPatch(patchId)) return mesh.patchTypes[patchId];
  std::string name = mesh.patchNames[patchId];
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* word : {"inlet", "outlet", "inflow", "outflow", "opening", "farfield"})
    if (name.find(word) != std::string::npos) return "patch";
  return "wall";
}

std::vector<std::string> foamPatchNames(const std::vector<std::string>& names) {
  const auto isLetter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto isOther = [](char c) { return (c >= '0' && c <= '9') || c == '-' || c == '.'; };
  std::vector<std::string> words;
  for (const std::string& name : names) {
    std::string word;
    for (char c : name) word += isLetter(c) || isOther(c) ? c : '_';
    words.push_back(word.empty() || !isLetter(word[0]) ? "patch_" + word : word);
  }
  // Names that were legal keep themselves; what became equal to another gets a number.
  std::unordered_set<std::string> given;
  std::vector<bool> done(words.size(), false);
  for (std::size_t i = 0; i < words.size(); ++i)
    done[i] = words[i] == names[i] && given.insert(words[i]).second;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (done[i]) continue;
    const std::string word = words[i];
    for (int number = 2; !given.insert(words[i]).second; ++number)
      words[i] = fmt::format("{}_{}", word, number);
  }
  return words;
}

void writePolyMesh(const PolyMesh& mesh, const std::string& directory, bool binary, Monitor& monitor) {
  const fs::path folder(directory);
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) cannotWrite(directory, code.value());

  const FaceOrder order = orderByPatch(mesh);
  std::vector<std::unique_ptr<FoamFile>> files;
  const auto open = [&](const char* name) -> FoamFile& {
    monitor.check(std::min(0.95, 0.2 * static_cast<double>(files.size())), kCaption);
    files.push_back(std::make_unique<FoamFile>(folder, name));
    return *files.back();
  };
  const std::string note =
      fmt::format("nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{}", mesh.points.size(), mesh.cellCount,
                  mesh.faceCount(), mesh.internalFaces());
  writePoints(mesh, open("points"), binary, monitor);
  writeFaces(mesh, order, open("faces"), binary, monitor);
  std::vector<Id> owner(mesh.owner.size());
  for (std::size_t i = 0; i < owner.size(); ++i) owner[i] = mesh.owner[order.faces[i]];
  FoamFile& ownerFile = open("owner");
  ownerFile.header("labelList", binary, note);
  labelList(ownerFile, owner, binary, monitor, 0.7);
  FoamFile& neighbourFile = open("neighbour");
  neighbourFile.header("labelList", binary, note);
  labelList(neighbourFile, mesh.neighbour, binary, monitor, 0.9);
  writeBoundary(mesh, order, open("boundary"));
  const bool hasZones = mesh.zoneNames.size() > 1;
  if (hasZones) writeCellZones(mesh, open("cellZones"), binary, monitor);
  for (const auto& file : files) file->close();
  monitor.check(1, kCaption);
  for (const auto& file : files) file->publish();
  removeStale(folder, hasZones);
}

}  // namespace pm
