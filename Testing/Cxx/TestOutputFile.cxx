// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace pm {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, removed afterwards.
class OutputFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        fs::temp_directory_path() / (std::string("pm_o_") + info->name() + "_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path() const { return (folder_ / "a.txt").string(); }
  std::string read() const {
    std::ifstream in(path(), std::ios::binary);
    std::stringstream all;
    all << in.rdbuf();
    return all.str();
  }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder_), {}); }
  fs::path folder_;
};

TEST_F(OutputFiles, IsThereOnlyWhenPublished) {
  std::ofstream(path()) << "old";
  {
    OutputFile file(path());
    file.text("new");
    file.close();
    EXPECT_EQ(read(), "old");
  }
  EXPECT_EQ(read(), "old");
  EXPECT_EQ(files(), 1);
  {
    OutputFile file(path());
    file.text("new");
    file.close();
    file.publish();
  }
  EXPECT_EQ(read(), "new");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFiles, DroppedUnclosedLeavesNothing) {
  { OutputFile(path()).text("half"); }
  EXPECT_EQ(files(), 0);
}

/// Some blocks and batches, and a bit more.
constexpr Id kItems = 16384 * 40 + 5;

std::string written(const std::string& path, Monitor& monitor) {
  OutputFile file(path);
  writeItems(file, kItems, monitor, "test",
             [](Id i, TextBuffer& out) { fmt::format_to(std::back_inserter(out), "{}\n", i); });
  file.close();
  file.publish();
  std::ifstream in(path, std::ios::binary);
  std::stringstream all;
  all << in.rdbuf();
  return all.str();
}

TEST_F(OutputFiles, ItemsAreInOrderForAnyNumberOfThreads) {
  Monitor monitor;
  const std::string text = written(path(), monitor);
  std::istringstream in(text);
  Id next = 0;
  for (Id value; in >> value; ++next) ASSERT_EQ(value, next);
  EXPECT_EQ(next, kItems);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(written(path(), monitor), text);
}

TEST_F(OutputFiles, ItemsReportProgressAndStop) {
  struct Stop : Monitor {
    double last = -1;
    int calls = 0;
    bool aborted() const override { return calls > 1; }
    void progress(double fraction, const std::string&) override {
      EXPECT_GT(fraction, last);
      last = fraction;
      ++calls;
    }
  } stop;
  EXPECT_THROW(written(path(), stop), AbortError);
  EXPECT_EQ(stop.calls, 2);
  EXPECT_EQ(files(), 0);
}

}  // namespace
}  // namespace pm
