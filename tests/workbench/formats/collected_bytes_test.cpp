#include "workbench/formats/collected_bytes.hpp"

#include <filesystem>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <kerf/error.hpp>

#include "support/scene_files.hpp"

namespace workbench {
namespace {

// Appends `text` in growing pieces, and returns what can be read then.
std::string collect(CollectedBytes& bytes, std::string_view text) {
  for (std::size_t begin = 0, piece = 1; begin < text.size(); begin += piece++)
    bytes.append(text.substr(begin, piece));
  const Mapping all = bytes.take();
  const std::string before(all.view());
  all.release(all.view());
  EXPECT_EQ(all.view(), before) << "what was released is read again";
  return before;
}

TEST(CollectedBytes, AreTheSameFromMemoryAndFromATemporaryFile) {
  const TemporaryDirectory directory;
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i);
  for (const std::size_t in_memory : {text.size(), text.size() - 1, std::size_t{100}, std::size_t{0}}) {
    CollectedBytes bytes("a.obj", in_memory, directory.path());
    EXPECT_EQ(collect(bytes, text), text) << in_memory << " in memory";
    EXPECT_EQ(bytes.size(), text.size());
    EXPECT_TRUE(std::filesystem::is_empty(directory.path())) << "the file has no name";
  }
}

TEST(CollectedBytes, SayWhereNoTemporaryFileCanBeMade) {
  CollectedBytes bytes("a.obj.gz", 10, "/no/such/folder");
  kerf_tests::expect_refused([&] { collect(bytes, "more than ten bytes"); }, kerf::Error::io,
                             "which need a temporary file, and /no/such/folder takes none: No such file");
}

TEST(CollectedBytes, OfNothingAreEmpty) {
  CollectedBytes bytes("a.obj");
  EXPECT_EQ(collect(bytes, ""), "");
}

}  // namespace
}  // namespace workbench
