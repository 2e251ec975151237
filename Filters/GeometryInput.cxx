// SPDX-License-Identifier: BSD-3-Clause
#include "GeometryInput.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <utility>

#include "GridArrays.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkTriangleFilter.h"
#include "vtkWeakPointer.h"

namespace pm {

namespace {

struct Block {
  vtkPolyData* surface = nullptr;
  std::string name;
};

/// What is gathered from the blocks for SurfaceModel.
struct Soup {
  std::vector<Vec3> points;
  std::vector<SurfaceModel::Triangle> triangles;
  std::vector<Id> patch;
  std::vector<std::string> names;
  std::map<std::string, Id> idOfName;

  Id patchNamed(const std::string& name) {
    const auto [found, isNew] = idOfName.try_emplace(name, static_cast<Id>(names.size()));
    if (isNew) names.push_back(name);
    return found->second;
  }
};

/// Appends the surfaces below data. A block without a name of its own has its parent's.
void addBlocks(vtkDataObject* data, const std::string& name, std::vector<Block>& blocks) {
  if (auto* surface = vtkPolyData::SafeDownCast(data)) {
    if (surface->GetNumberOfCells() > 0) blocks.push_back({surface, name});
    return;
  }
  auto* tree = vtkDataObjectTree::SafeDownCast(data);
  if (!tree) return;
  vtkSmartPointer<vtkDataObjectTreeIterator> it;
  it.TakeReference(tree->NewTreeIterator());
  it->TraverseSubTreeOff();
  it->VisitOnlyLeavesOff();
  for (it->InitTraversal(); !it->IsDoneWithTraversal(); it->GoToNextItem()) {
    const char* own = nullptr;
    if (it->HasCurrentMetaData()) own = it->GetCurrentMetaData()->Get(vtkCompositeDataSet::NAME());
    const std::string inherited = name.empty() ? "block" + std::to_string(blocks.size()) : name;
    addBlocks(it->GetCurrentDataObject(), own && *own ? own : inherited, blocks);
  }
}

/// The block with triangles as its only cells; the input itself where it is so already.
vtkSmartPointer<vtkPolyData> triangulated(vtkPolyData* surface) {
  const bool onlyTriangles =
      surface->GetNumberOfPolys() == surface->GetNumberOfCells() && surface->GetPolys()->IsHomogeneous() == 3;
  if (onlyTriangles) return surface;
  vtkNew<vtkTriangleFilter> filter;
  vtkNew<vtkPolyData> copy;  // the input must not become part of another pipeline
  copy->ShallowCopy(surface);
  filter->SetInputData(copy);
  filter->PassVertsOff();
  filter->PassLinesOff();
  filter->Update();
  return filter->GetOutput();
}

/// The array that tells patches apart, null = none.
vtkAbstractArray* patchArrayOf(vtkPolyData* surface, const std::string& wanted) {
  vtkCellData* data = surface->GetCellData();
  if (!wanted.empty()) {
    vtkAbstractArray* array = data->GetAbstractArray(wanted.c_str());
    if (!array || array->GetNumberOfComponents() != 1) {
      throw InputError("The geometry has no cell array " + wanted +
                       " of one component to tell patches by; choose another patch array or leave it empty.");
    }
    return array;
  }
  for (const char* name :
       {"PatchId", "PatchIds", "GroupIds", "STLSolidLabeling", "MaterialIds", "RegionId"}) {
    vtkDataArray* array = data->GetArray(name);
    if (array && array->GetNumberOfComponents() == 1) return array;
  }
  return nullptr;
}

std::vector<std::string> namesFor(vtkPolyData* surface, const std::string& array) {
  std::vector<std::string> keys{array + "Names"};
  for (const char* ending : {"Ids", "Id"}) {
    const std::string end = ending;
    if (array.size() > end.size() && array.compare(array.size() - end.size(), end.size(), end) == 0) {
      keys.push_back(array.substr(0, array.size() - end.size()) + "Names");
    }
  }
  keys.push_back("PatchNames");
  for (const std::string& key : keys) {
    std::vector<std::string> names = readStrings(surface->GetFieldData(), key.c_str());
    if (!names.empty()) return names;
  }
  return {};
}

/// Patch of each triangle from a cell array of names or of ids.
void addPatchesFromArray(vtkPolyData* surface, vtkAbstractArray* array, Soup& soup) {
  const vtkIdType count = surface->GetNumberOfCells();
  if (auto* strings = vtkStringArray::SafeDownCast(array)) {
    for (vtkIdType i = 0; i < count; ++i) soup.patch.push_back(soup.patchNamed(strings->GetValue(i)));
    return;
  }
  auto* numbers = vtkDataArray::SafeDownCast(array);
  if (!numbers)
    throw InputError(std::string("The patch array ") + array->GetName() + " holds no ids or names.");
  std::vector<std::int64_t> ids(count);
  for (vtkIdType i = 0; i < count; ++i) ids[i] = static_cast<std::int64_t>(numbers->GetComponent(i, 0));
  const std::vector<std::string> names = namesFor(surface, array->GetName());
  std::map<std::int64_t, Id> patchOfId;
  for (std::int64_t id : ids) patchOfId.emplace(id, kNone);
  for (auto& [id, patch] : patchOfId) {  // ascending ids
    const bool named = id >= 0 && id < static_cast<std::int64_t>(names.size()) && !names[id].empty();
    patch = soup.patchNamed(named ? names[id] : "patch" + std::to_string(id));
  }
  for (std::int64_t id : ids) soup.patch.push_back(patchOfId[id]);
}

void addTriangles(vtkPolyData* surface, Soup& soup) {
  const vtkIdType points = surface->GetNumberOfPoints(), cells = surface->GetNumberOfCells();
  const vtkIdType limit = std::numeric_limits<Id>::max();
  if (points + vtkIdType(soup.points.size()) > limit || cells + vtkIdType(soup.triangles.size()) > limit) {
    throw InputError(
        "The geometry has more than two thousand million points or triangles; decimate it first.");
  }
  const Id first = static_cast<Id>(soup.points.size());
  soup.points.resize(first + points);
  for (vtkIdType p = 0; p < points; ++p) surface->GetPoint(p, soup.points[first + p].data());
  soup.triangles.reserve(soup.triangles.size() + cells);
  vtkCellArray* polys = surface->GetPolys();
  vtkIdType size = 0;
  const vtkIdType* ids = nullptr;
  for (vtkIdType cell = 0; cell < cells; ++cell) {
    polys->GetCellAtId(cell, size, ids);
    soup.triangles.push_back(
        {static_cast<Id>(first + ids[0]), static_cast<Id>(first + ids[1]), static_cast<Id>(first + ids[2])});
  }
}

Soup gather(const std::vector<Block>& blocks, const std::string& wanted) {
  Soup soup;
  for (const Block& block : blocks) {
    const vtkSmartPointer<vtkPolyData> surface = triangulated(block.surface);
    if (surface->GetNumberOfCells() == 0) continue;
    vtkAbstractArray* array = wanted.empty() && blocks.size() > 1 ? nullptr : patchArrayOf(surface, wanted);
    if (array) {
      addPatchesFromArray(surface, array, soup);
    } else {
      const Id patch = soup.patchNamed(block.name.empty() ? "wall" : block.name);
      soup.patch.resize(soup.patch.size() + surface->GetNumberOfCells(), patch);
    }
    addTriangles(surface, soup);
  }
  if (soup.triangles.empty()) {
    throw InputError(
        "The geometry has no triangles; give it a surface of polygons (lines and points do not count).");
  }
  return soup;
}

/// Two sums over all bytes of a soup: equal for equal content.
struct Digest {
  std::uint64_t a = 0x9e3779b97f4a7c15ull, b = 0xc2b2ae3d27d4eb4full;

  bool operator==(const Digest& other) const { return a == other.a && b == other.b; }
  void add(const void* data, std::size_t count) {
    add(count);
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (; count >= 8; bytes += 8, count -= 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes, 8);
      add(word);
    }
    std::uint64_t rest = 0;
    std::memcpy(&rest, bytes, count);
    add(rest);
  }

 private:
  void add(std::uint64_t word) {
    a = (a ^ word) * 0xff51afd7ed558ccdull;
    a ^= a >> 29;
    b = (b + word) * 0xc4ceb9fe1a85ec53ull;
    b ^= b >> 31;
  }
};

Digest digestOf(const Soup& soup) {
  Digest d;
  const auto addAll = [&](const auto& values) { d.add(values.data(), values.size() * sizeof values[0]); };
  addAll(soup.points);
  addAll(soup.triangles);
  addAll(soup.patch);
  for (const std::string& name : soup.names) d.add(name.data(), name.size());
  return d;
}

/// Where a model came from: data objects as they were at a time, and how patches were told apart.
struct Origin {
  struct Part {
    vtkWeakPointer<vtkPolyData> surface;  // null when it is gone, so that a new one at its address is another
    vtkMTimeType modified;
    std::string name;
    bool operator==(const Part& p) const {
      return surface && surface == p.surface && modified == p.modified && name == p.name;
    }
  };
  std::vector<Part> parts;
  std::string patchArray;

  Origin(const std::vector<Block>& blocks, const std::string& wanted) : patchArray(wanted) {
    for (const Block& block : blocks) {
      vtkPolyData* s = block.surface;
      vtkMTimeType modified = std::max(s->GetMTime(), s->GetFieldData()->GetMTime());
      modified = std::max(modified, s->GetPolys()->GetConnectivityArray()->GetMTime());
      parts.push_back({s, modified, block.name});
    }
  }
  bool operator==(const Origin& o) const { return parts == o.parts && patchArray == o.patchArray; }
};

/// The models that some filter holds: found again by their origin, which costs nothing, or by their content.
class Models {
 public:
  using Model = std::shared_ptr<const SurfaceModel>;

  Model find(const Origin& origin) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const Entry& entry : entries_)
      if (entry.origin == origin)
        if (Model model = entry.model.lock()) return model;
    return nullptr;
  }
  Model find(const Digest& digest) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const Entry& entry : entries_)
      if (entry.digest == digest)
        if (Model model = entry.model.lock()) return model;
    return nullptr;
  }
  void add(const Origin& origin, const Digest& digest, const Model& model) {
    const std::lock_guard<std::mutex> lock(mutex_);
    entries_.erase(
        std::remove_if(entries_.begin(), entries_.end(), [](const Entry& e) { return e.model.expired(); }),
        entries_.end());
    entries_.push_back({origin, digest, model});
  }

 private:
  struct Entry {
    Origin origin;
    Digest digest;
    std::weak_ptr<const SurfaceModel> model;
  };
  std::mutex mutex_;
  std::vector<Entry> entries_;
};

}  // namespace

std::shared_ptr<const SurfaceModel> surfaceFrom(vtkDataObject* data, const char* patchArray) {
  static Models models;
  const std::string wanted = patchArray ? patchArray : "";
  std::vector<Block> blocks;
  addBlocks(data, "", blocks);
  const Origin origin(blocks, wanted);
  if (Models::Model known = models.find(origin)) return known;
  const Soup soup = gather(blocks, wanted);
  const Digest digest = digestOf(soup);
  Models::Model model = models.find(digest);
  if (!model) model = std::make_shared<SurfaceModel>(soup.points, soup.triangles, soup.patch, soup.names);
  models.add(origin, digest, model);
  return model;
}

}  // namespace pm
