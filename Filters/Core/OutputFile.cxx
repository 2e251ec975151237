// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace pm {

void cannotWrite(const std::string& path, int code) {
  throw InputError("Cannot write " + path + ": " + std::strerror(code) +
                   ". Choose another folder or free some space on the disk.");
}

OutputFile::OutputFile(const std::string& path) : path_(path), part_(path + ".part") {
  file_ = std::fopen(part_.c_str(), "wb");
  if (!file_) cannotWrite(path_, errno);
}

OutputFile::~OutputFile() {
  if (file_) std::fclose(file_);
  std::error_code ignored;
  if (!published_) std::filesystem::remove(part_, ignored);
}

void OutputFile::bytes(const void* data, std::size_t count) {
  if (count > 0 && std::fwrite(data, 1, count, file_) != count) cannotWrite(path_, errno);
}

void OutputFile::close() {
  std::FILE* file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0) cannotWrite(path_, errno);
}

void OutputFile::publish() {
  std::error_code code;
  std::filesystem::rename(part_, path_, code);
  if (code) cannotWrite(path_, code.value());
  published_ = true;
}

}  // namespace pm
