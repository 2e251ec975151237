// SPDX-License-Identifier: BSD-3-Clause
// Files that are written whole or not at all, and lists whose items are formatted in parallel: what the
// writers share.
#pragma once

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "Monitor.h"

namespace pm {

/// A file that is written beside its final place (".part" behind its name). publish() puts it there; what was
/// not published is removed by the destructor, and a file that stood there stays as it was. Everything throws
/// InputError, with the path and the system's reason, when the file cannot be written.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void text(fmt::string_view s) { bytes(s.data(), s.size()); }
  void bytes(const void* data, std::size_t count);
  /// After the last byte, before publish(): of several files all are closed before the first is published.
  void close();
  void publish();

 private:
  std::string path_, part_;
  std::FILE* file_ = nullptr;
  bool published_ = false;
};

/// Throws the InputError of a path that cannot be written; code: of errno.
[[noreturn]] void cannotWrite(const std::string& path, int code);

using TextBuffer = fmt::memory_buffer;

/// The bytes of a number as they lie in memory.
template <class T>
void appendRaw(TextBuffer& out, const T& value) {
  const char* bytes = reinterpret_cast<const char*>(&value);
  out.append(bytes, bytes + sizeof(T));
}

/// Writes what format(i, buffer) appends for each i below count; items are formatted in parallel, written in
/// order.
template <class Format>
void writeItems(OutputFile& file, Id count, Monitor& monitor, const std::string& caption,
                const Format& format) {
  constexpr Id kBlock = 16384, kBatch = 16;
  std::vector<TextBuffer> buffers(kBatch);
  for (Id start = 0, end = 0; start < count; start = end) {
    monitor.check(static_cast<double>(start) / count, caption);
    end = count - start < kBlock * kBatch ? count : start + kBlock * kBatch;
    const Id blocks = (end - start + kBlock - 1) / kBlock;
    tbb::parallel_for(Id(0), blocks, [&](Id b) {
      const Id first = start + b * kBlock, last = std::min(end, first + kBlock);
      buffers[b].clear();
      for (Id i = first; i < last; ++i) format(i, buffers[b]);
    });
    for (Id b = 0; b < blocks; ++b) file.bytes(buffers[b].data(), buffers[b].size());
  }
}

}  // namespace pm
