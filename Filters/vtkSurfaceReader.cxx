// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSurfaceReader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <map>

#include "GridArrays.h"
#include "SurfaceNames.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkErrorCode.h"
#include "vtkInformationVector.h"
#include "vtkOBJReader.h"
#include "vtkObjectFactory.h"
#include "vtkPLYReader.h"
#include "vtkPolyData.h"
#include "vtkSTLReader.h"
#include "vtkSmartPointer.h"
#include "vtkTypeInt32Array.h"
#include "vtkXMLPolyDataReader.h"
#include "vtk_zlib.h"

namespace fs = std::filesystem;

namespace {

/// A plain copy of a gzip'd file, gone with this object. Zero bytes of an OBJ file end lines: it is text, and
/// what an archive wraps around it then is lines without meaning.
class UnpackedFile {
 public:
  UnpackedFile(const fs::path& packed, const std::string& extension) {
    path_ = (fs::temp_directory_path() / "surfaceXXXXXX").string() + extension;
    const int descriptor = mkstemps(path_.data(), static_cast<int>(extension.size()));
    if (descriptor < 0)
      throw pm::InputError("No temporary file can be made to unpack " + packed.string() + ".");
    std::FILE* out = fdopen(descriptor, "wb");
    const bool good = copy(packed, extension == ".obj", out);
    if (std::fclose(out) != 0 || !good) {
      std::remove(path_.c_str());
      throw pm::InputError("The file " + packed.string() +
                           " cannot be unpacked: it is damaged or the disk is full.");
    }
  }
  ~UnpackedFile() { std::remove(path_.c_str()); }
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  static bool copy(const fs::path& packed, bool isText, std::FILE* out) {
    gzFile in = gzopen(packed.c_str(), "rb");
    if (!in) return false;
    std::vector<char> buffer(1 << 20);
    int got = 0;
    bool written = true;
    while (written && (got = gzread(in, buffer.data(), static_cast<unsigned>(buffer.size()))) > 0) {
      if (isText) std::replace(buffer.begin(), buffer.begin() + got, '\0', '\n');
      written = std::fwrite(buffer.data(), 1, got, out) == static_cast<std::size_t>(got);
    }
    return gzclose(in) == Z_OK && got == 0 && written;
  }
  std::string path_;
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Puts the patches into the surface: parts of equal name are one, patches in order of appearance.
void addPatches(vtkPolyData* surface, const std::vector<pm::Id>& part,
                const std::vector<std::string>& partNames) {
  std::vector<std::string> names;
  std::map<std::string, pm::Id> patchOfName;
  std::vector<pm::Id> patchOfPart(partNames.size(), pm::kNone), patch(part.size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    pm::Id& known = patchOfPart[part[i]];
    if (known == pm::kNone) {
      const std::string& name = partNames[part[i]];
      const auto [found, isNew] = patchOfName.try_emplace(name, static_cast<pm::Id>(names.size()));
      if (isNew) names.push_back(name);
      known = found->second;
    }
    patch[i] = known;
  }
  pm::addArray<vtkTypeInt32Array>(surface->GetCellData(), "PatchId", patch);
  pm::addStrings(surface->GetFieldData(), "PatchNames", names);
}

/// Gives nameless parts the file's own name, numbered when there are several.
void nameTheNameless(std::vector<std::string>& names, const std::string& stem) {
  const auto nameless = std::count(names.begin(), names.end(), std::string());
  int number = 0;
  for (std::string& name : names) {
    if (name.empty()) name = nameless > 1 ? stem + "_" + std::to_string(number++) : stem;
  }
}

void readStl(const std::string& path, const std::string& stem, vtkPolyData* surface) {
  vtkNew<vtkSTLReader> reader;
  reader->SetFileName(path.c_str());
  reader->ScalarTagsOn();
  reader->Update();
  vtkPolyData* read = reader->GetOutput();
  surface->SetPoints(read->GetPoints());
  surface->SetPolys(read->GetPolys());
  std::vector<pm::Id> solid = pm::readArray<pm::Id>(read->GetCellData(), "STLSolidLabeling");
  solid.resize(read->GetNumberOfPolys(), 0);  // a binary file has no labels: one solid
  std::vector<std::string> names;
  if (read->GetCellData()->HasArray("STLSolidLabeling")) names = pm::scanStlNames(path);
  const pm::Id solids = solid.empty() ? 0 : *std::max_element(solid.begin(), solid.end()) + 1;
  names.resize(std::max<std::size_t>(names.size(), solids));
  nameTheNameless(names, stem);
  addPatches(surface, solid, names);
}

void readObj(const std::string& path, const std::string& stem, vtkPolyData* surface) {
  vtkNew<vtkOBJReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkPolyData* read = reader->GetOutput();
  surface->SetPoints(read->GetPoints());
  surface->SetPolys(read->GetPolys());
  const pm::NamedFaces named = pm::scanObjNames(path);
  const vtkIdType faces = read->GetNumberOfPolys();
  if (named.faces != faces) {
    throw pm::InputError("The OBJ file has " + std::to_string(named.faces) + " faces, of which " +
                         std::to_string(faces) + " could be read; repair or export it again.");
  }
  std::vector<std::string> names{std::string()};  // part 0: before the first name
  std::vector<pm::Id> part(faces, 0);
  for (std::size_t run = 0; run < named.runs.size(); ++run) {
    const bool last = run + 1 == named.runs.size();
    names.push_back(named.runs[run].name);
    std::fill(part.begin() + named.runs[run].firstFace,
              last ? part.end() : part.begin() + named.runs[run + 1].firstFace, static_cast<pm::Id>(run + 1));
  }
  std::replace(names.begin(), names.end(), std::string(), stem);
  addPatches(surface, part, names);
}

void readPly(const std::string& path, const std::string& stem, vtkPolyData* surface) {
  vtkNew<vtkPLYReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  surface->SetPoints(reader->GetOutput()->GetPoints());
  surface->SetPolys(reader->GetOutput()->GetPolys());
  addPatches(surface, std::vector<pm::Id>(surface->GetNumberOfPolys(), 0), {stem});
}

void readVtp(const std::string& path, vtkPolyData* surface) {
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  surface->ShallowCopy(reader->GetOutput());
}

/// path: a plain file; extension: lower case, with the dot.
void readPlain(const std::string& path, const std::string& extension, const std::string& stem,
               vtkPolyData* surface) {
  if (extension == ".stl") return readStl(path, stem, surface);
  if (extension == ".obj") return readObj(path, stem, surface);
  if (extension == ".ply") return readPly(path, stem, surface);
  if (extension == ".vtp") return readVtp(path, surface);
  throw pm::InputError("Files that end in \"" + extension +
                       "\" cannot be read; use .stl, .obj, .ply or .vtp, also .gz.");
}

void read(const fs::path& file, vtkPolyData* surface) {
  if (!fs::is_regular_file(file))
    throw pm::InputError("There is no file " + file.string() + "; check its path.");
  const bool packed = lower(file.extension().string()) == ".gz";
  const fs::path plain = packed ? fs::path(file).replace_extension() : file;
  const std::string extension = lower(plain.extension().string()), stem = plain.stem().string();
  if (packed) {
    const UnpackedFile unpacked(file, extension);
    readPlain(unpacked.path(), extension, stem, surface);
  } else {
    readPlain(file.string(), extension, stem, surface);
  }
  if (surface->GetNumberOfCells() == 0) {
    throw pm::InputError("The file " + file.string() + " holds no triangles that can be read.");
  }
}

}  // namespace

vtkStandardNewMacro(vtkSurfaceReader);

vtkSurfaceReader::vtkSurfaceReader() { this->SetNumberOfInputPorts(0); }

vtkSurfaceReader::~vtkSurfaceReader() { this->SetFileName(nullptr); }

int vtkSurfaceReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) {
  vtkPolyData* surface = vtkPolyData::GetData(outputs);
  try {
    if (!this->FileName || !*this->FileName) throw pm::InputError("No file is named; set FileName.");
    read(this->FileName, surface);
    return 1;
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
  }
  surface->Initialize();
  return 0;
}

void vtkSurfaceReader::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
}
