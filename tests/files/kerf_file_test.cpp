// .kerf files: what is saved comes back, and what is damaged does not.
#include <algorithm>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <tbb/global_control.h>

#include "fuzz/forged_file.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/instrumented.hpp"
#include "support/node_width.hpp"
#include "support/targets.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/generate/solids.hpp"
#include "workbench/rays/aimed_rays.hpp"

namespace kerf {
namespace {

std::span<const std::byte> bytes_of(const std::string& file) {
  return std::as_bytes(std::span(file));
}

// The code and the sentence of the error that `work` throws.
template <class Work>
std::pair<int, std::string> error_of(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {-1, "no error"};
}

std::string saved(const Bvh& bvh) {
  const TemporaryDirectory directory;
  bvh.save(directory / "scene.kerf");
  return read_bytes(directory / "scene.kerf");
}

TEST(KerfFile, LoadedAndMappedAnswerAsSaved) {
  const workbench::Solid torus = workbench::make_torus(48, 24),
                         box = workbench::make_box({-1, -1, -1}, {1, 1, 1}, 4);
  const TriangleMesh meshes[] = {torus.mesh(), {}, box.mesh()};
  const Bvh bvh = build(meshes, spatial_splits_everywhere());
  const TemporaryDirectory directory;
  bvh.save(directory / "scene.kerf");
  const Bvh loaded = Bvh::load(directory / "scene.kerf"), mapped = Bvh::map(directory / "scene.kerf");
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray{.origin = adversarial::uniform_point(random, 2.0f),
                  .direction = adversarial::uniform_point(random, 1.0f)};
    const auto hit = bvh.intersect(ray);
    ASSERT_EQ(loaded.intersect(ray), hit);
    ASSERT_EQ(mapped.intersect(ray), hit);
    ASSERT_EQ(mapped.contains(ray.origin), bvh.contains(ray.origin));
  }
  for (const Bvh& again : {loaded, mapped}) {
    EXPECT_EQ(again.bounds(), bvh.bounds());
    EXPECT_EQ(again.statistics().triangles, bvh.statistics().triangles);
    EXPECT_EQ(again.statistics().references, bvh.statistics().references);
    EXPECT_EQ(again.statistics().nodes, bvh.statistics().nodes);
    EXPECT_EQ(again.statistics().bytes, bvh.statistics().bytes);
    EXPECT_EQ(saved(again), saved(bvh));
  }
}

TEST(KerfFile, BytesInMemoryAreThoseOfTheFile) {
  const workbench::Solid torus = workbench::make_torus(48, 24);
  for (const Bvh& bvh : {build(torus.mesh(), spatial_splits_everywhere()), Bvh()}) {
    const std::string file = saved(bvh);
    const std::vector<std::byte> bytes = bvh.save();
    ASSERT_TRUE(std::ranges::equal(bytes, bytes_of(file)));
    EXPECT_EQ(saved(Bvh::load(bytes)), file);
    // At an address that is no multiple of anything, and no longer there once loaded.
    std::vector<std::byte> moved(bytes.size() + 1);
    std::ranges::copy(bytes, moved.begin() + 1);
    const Bvh loaded = Bvh::load(std::span(moved).subspan(1));
    std::ranges::fill(moved, std::byte{0});
    EXPECT_EQ(saved(loaded), file);
  }
}

TEST(KerfFile, DamagedBytesInMemoryAreRefused) {
  const std::vector<std::byte> bytes = build(workbench::make_torus(24, 12).mesh()).save();
  for (std::size_t size : {std::size_t{0}, std::size_t{10}, bytes.size() - 1})
    EXPECT_EQ(error_of([&] { Bvh::load(std::span(bytes).first(size)); }).first, Error::bad_format);
  for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 64) {
    std::vector<std::byte> damaged = bytes;
    damaged[at] ^= std::byte{4};
    EXPECT_EQ(error_of([&] { Bvh::load(damaged); }).first, Error::bad_format) << at;
  }
}

TEST(KerfFile, KeepsTheMasksOfMeshes) {
  const workbench::Solid outer = workbench::make_box({-2, -2, -2}, {2, 2, 2}),
                         inner = workbench::make_box({-1, -1, -1}, {1, 1, 1});
  TriangleMesh meshes[] = {outer.mesh(), {}, inner.mesh()};
  meshes[0].mask = Mask{1};
  const Bvh bvh = build(meshes);
  const TemporaryDirectory directory;
  bvh.save(directory / "boxes.kerf");
  const Ray ray{.origin = {-3, 0.1f, 0.2f}, .direction = {1, 0, 0}};
  for (const Bvh& again : {Bvh::load(directory / "boxes.kerf"), Bvh::map(directory / "boxes.kerf")}) {
    for (const Mask mask : {Mask{1}, Mask{2}, Mask{}})
      EXPECT_EQ(again.intersect(ray, mask), bvh.intersect(ray, mask)) << mask.bits;
    EXPECT_EQ(saved(again), saved(bvh));
  }
}

// Margins of boxes matter far from the origin, for rays at vertices and edges.
TEST(KerfFile, ALoadedHierarchyIsAsWatertightAsTheSavedOne) {
  const TemporaryDirectory directory;
  for (const auto& [name, solid] : workbench::make_watertight_solids()) {
    const Bvh bvh = build(solid.mesh(), spatial_splits_everywhere());
    bvh.save(directory / "solid.kerf");
    for (const Bvh& again : {Bvh::load(directory / "solid.kerf"), Bvh::map(directory / "solid.kerf")}) {
      const workbench::AimedRayCounts counts =
          workbench::trace_aimed_rays(solid, again, test::reduced(2000), 1);
      EXPECT_EQ(counts.leaks, 0u) << name;
      EXPECT_EQ(counts.parity_errors, 0u) << name;
    }
  }
}

TEST(KerfFile, AnEmptyHierarchySurvives) {
  const TemporaryDirectory directory;
  for (const Bvh& empty : {Bvh(), build(TriangleMesh{}), build(std::span<const TriangleMesh>())}) {
    empty.save(directory / "empty.kerf");
    for (const Bvh& again : {Bvh::load(directory / "empty.kerf"), Bvh::map(directory / "empty.kerf")}) {
      EXPECT_FALSE(again.intersect({.origin = {0, 0, 0}, .direction = {1, 0, 0}}).has_value());
      EXPECT_EQ(saved(again), read_bytes(directory / "empty.kerf"));
    }
  }
}

TEST(KerfFile, AMappedFileMayBeReplacedWhileItIsUsed) {
  const TemporaryDirectory directory;
  build(workbench::make_sphere(2).mesh()).save(directory / "scene.kerf");
  const Bvh mapped = Bvh::map(directory / "scene.kerf");
  Bvh().save(directory / "scene.kerf");
  EXPECT_TRUE(mapped.contains({0, 0, 0}));
  EXPECT_FALSE(Bvh::map(directory / "scene.kerf").contains({0, 0, 0}));
}

TEST(KerfFile, TheSameBytesForAnyNumberOfThreadsAndOnEveryRun) {
  // Without this, oneTBB has at most as many threads as the machine has cores.
  const tbb::global_control eight_threads(tbb::global_control::max_allowed_parallelism, 8);
  const workbench::Solid solid = workbench::make_torus(192, 96);
  std::string first;
  for (const unsigned threads : {1u, 2u, 4u, 8u}) {
    for (int run = 0; run < 10; ++run) {
      BuildOptions options;
      options.threads = threads;
      const std::string file = saved(build(solid.mesh(), options));
      if (first.empty()) first = file;
      ASSERT_EQ(file, first) << threads << " threads, run " << run;
    }
  }
}

TEST(KerfFile, LeavesNothingElseBehind) {
  const TemporaryDirectory directory;
  Bvh().save(directory / "a.kerf");
  Bvh().save(directory / "a.kerf");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1);
}

TEST(KerfFile, WhatCannotBeReadOrWrittenIsNamed) {
  const TemporaryDirectory directory;
  const std::string missing = (directory / "missing.kerf").string();
  EXPECT_EQ(error_of([&] { Bvh::load(missing); }),
            std::pair(int{Error::io}, missing + ": cannot be opened: No such file or directory"));
  EXPECT_EQ(error_of([&] { Bvh::map(directory.path()); }).first, Error::io);
  EXPECT_EQ(error_of([&] { Bvh::load("/dev/zero"); }).first, Error::io);
  EXPECT_EQ(error_of([&] { Bvh().save(directory / "no/such/place.kerf"); }).first, Error::io);
  EXPECT_EQ(error_of([&] { Bvh().save(directory.path()); }).first, Error::io);
  write_bytes(directory / "empty.kerf", "");
  EXPECT_EQ(error_of([&] { Bvh::load(directory / "empty.kerf"); }),
            std::pair(int{Error::bad_format}, (directory / "empty.kerf").string() + ": the file is empty"));
  write_bytes(directory / "text.kerf", "v 0 0 0\n");
  EXPECT_EQ(
      error_of([&] { Bvh::map(directory / "text.kerf"); }),
      std::pair(int{Error::bad_format}, (directory / "text.kerf").string() + ": this is not a .kerf file"));
}

TEST(KerfFile, SavingReplacesFilesAndNothingElse) {
  const TemporaryDirectory directory;
  const std::filesystem::path pipe = directory / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error_of([&] { Bvh().save(pipe); }),
            std::pair(int{Error::io}, pipe.string() + ": is not a file that can be replaced"));
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_EQ(error_of([&] { Bvh::load(pipe); }).first, Error::io);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1);
}

TEST(KerfFile, SavingFollowsLinks) {
  const TemporaryDirectory directory;
  std::filesystem::create_symlink("middle", directory / "first");
  std::filesystem::create_symlink(directory / "scene.kerf", directory / "middle");
  for (int time = 0; time < 2; ++time) {  // nothing is there at first, then a file
    Bvh().save(directory / "first");
    EXPECT_TRUE(std::filesystem::is_symlink(directory / "first"));
    EXPECT_TRUE(std::filesystem::is_symlink(directory / "middle"));
    EXPECT_NO_THROW(Bvh::load(directory / "scene.kerf"));
  }
  std::filesystem::create_symlink("round", directory / "round");
  EXPECT_EQ(error_of([&] { Bvh().save(directory / "round"); }).first, Error::io);
}

TEST(KerfFile, SavingKeepsThePermissionsOfTheOldFile) {
  const TemporaryDirectory directory;
  using std::filesystem::perms;
  for (const perms mode : {perms::owner_read | perms::owner_write, perms(0664)}) {
    Bvh().save(directory / "scene.kerf");
    std::filesystem::permissions(directory / "scene.kerf", mode);
    Bvh().save(directory / "scene.kerf");
    EXPECT_EQ(std::filesystem::status(directory / "scene.kerf").permissions(), mode);
  }
}

TEST(KerfFile, NamesMayBeAsLongAsTheSystemAllows) {
  const TemporaryDirectory directory;
  for (const std::size_t length : {240u, 241u, 255u}) {
    const std::filesystem::path path = directory / std::string(length, 'n');
    Bvh().save(path);
    Bvh().save(path);
    EXPECT_NO_THROW(Bvh::load(path)) << length;
  }
  EXPECT_EQ(error_of([&] { Bvh().save(directory / std::string(256, 'n')); }).first, Error::io);
}

TEST(KerfFile, APathWithAZeroByteNamesNoFile) {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory / std::string("a\0b", 3);
  Bvh().save(directory / "a");
  EXPECT_EQ(error_of([&] { Bvh().save(path); }).first, Error::io);
  EXPECT_EQ(error_of([&] { Bvh::load(path); }).first, Error::io);
  EXPECT_EQ(error_of([&] { Bvh::map(path); }).first, Error::io);
}

TEST(KerfFile, OtherVersionsAndByteOrdersAreToldFromDamage) {
  std::string file = saved(Bvh());
  const auto sentence = [](const std::string& bytes) {
    return error_of([&] { forged::load(bytes_of(bytes)); }).second;
  };
  std::string swapped = file;
  std::reverse(swapped.begin() + 8, swapped.begin() + 12);
  EXPECT_EQ(sentence(swapped), "the file was written on a machine with the other byte order");
  file[12] = 9;
  EXPECT_EQ(sentence(file), "the file has format version 9, but this kerf reads versions 2 to 3");
}

TEST(KerfFile, EveryTruncationAndEveryChangedByteIsRefused) {
  const workbench::Solid sphere = workbench::make_sphere(0);
  TriangleMesh mesh = sphere.mesh();
  mesh.mask = Mask{5};
  const std::string file = saved(build(mesh));
  for (std::size_t length = 0; length < file.size(); ++length) {
    ASSERT_EQ(error_of([&] { forged::load(bytes_of(file.substr(0, length))); }).first, Error::bad_format)
        << length;
  }
  ASSERT_EQ(error_of([&] { forged::load(bytes_of(file + '\0')); }).first, Error::bad_format);
  std::string changed = file;
  for (std::size_t i = 0; i < file.size(); ++i) {
    for (int change = 1; change < 256; ++change) {
      changed[i] = static_cast<char>(file[i] ^ change);
      ASSERT_EQ(error_of([&] { forged::load(bytes_of(changed)); }).first, Error::bad_format)
          << "byte " << i << " changed by " << change;
    }
    changed[i] = file[i];
  }
}

// Signs `file` again, as a forger can. It must be refused, which is counted, or answer.
void present_forged(std::string file, std::size_t& refused) {
  forged::sign(std::as_writable_bytes(std::span(file)));
  try {
    forged::query(forged::load(bytes_of(file)));
  } catch (const Error& error) {
    ASSERT_EQ(error.code(), Error::bad_format);
    ++refused;
  }
}

TEST(KerfFile, AForgedFileIsRefusedOrAnswers) {
  const std::string file = saved(build(workbench::make_sphere(1).mesh()));
  std::size_t shown = 0, refused = 0;
  for (std::size_t i = 0; i < file.size(); ++i) {
    for (const int value : {0x00, 0x7f, 0xff}) {
      std::string changed = file;
      changed[i] = static_cast<char>(value);
      present_forged(changed, refused);
      ++shown;
    }
  }
  EXPECT_LT(refused, shown);  // coordinates may be changed at will,
  EXPECT_GT(refused, 0u);     // links may not
}

TEST(KerfFile, EveryForgedByteOfASmallFileIsRefusedOrAnswers) {
  const std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::uint32_t> indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const std::string file = saved(build({.vertices = vertices, .triangles = indices}));
  std::size_t shown = 0, refused = 0;
  for (std::size_t i = 0; i < file.size(); ++i) {
    std::string changed = file;
    for (int change = 1; change < 256; ++change) {
      changed[i] = static_cast<char>(file[i] ^ change);
      present_forged(changed, refused);
      ++shown;
    }
  }
  EXPECT_LT(refused, shown);
  EXPECT_GT(refused, 0u);
  refused = 0;
  for (std::size_t length = 0; length < file.size(); ++length)
    present_forged(file.substr(0, length), refused);
  EXPECT_EQ(refused, file.size());
}

TEST(KerfFile, AWidthOfNodesThatThereIsNotIsRefused) {
  const std::string file = saved(build(workbench::make_sphere(0).mesh()));
  for (const std::uint32_t width : {0u, 1u, 5u, 12u, 32u, 0x01000010u}) {
    std::string changed = file;
    std::memcpy(changed.data() + offsetof(FileHeader, node_width), &width, sizeof width);
    forged::sign(std::as_writable_bytes(std::span(changed)));
    EXPECT_EQ(error_of([&] { forged::load(bytes_of(changed)); }).second,
              "the header names nodes of " + std::to_string(width) + " children, but there are 16, 8 or 4");
  }
}

// A traversal finds a shuffle in a table by the order of a node of four children.
TEST(KerfFile, AnOrderWithMoreThanItsSlotsIsRefused) {
  using Node = WideNode<4>;
  std::string file = saved(kerf_tests::with_node_width(build(workbench::make_sphere(0).mesh()), 4));
  FileHeader header;
  std::memcpy(&header, file.data(), sizeof header);
  file[FileLayout(header).nodes_at + offsetof(Node, order) + 1] = 1;
  forged::sign(std::as_writable_bytes(std::span(file)));
  EXPECT_EQ(error_of([&] { forged::load(bytes_of(file)); }).second,
            "a node whose visiting order does not name each child once (0)");
}

// Version 2 knew nodes of sixteen children only, and had a zero where their width stands now.
TEST(KerfFile, FilesOfTheVersionBeforeAreRead) {
  const Bvh bvh = build(workbench::make_sphere(3).mesh());
  std::string file = saved(kerf_tests::with_node_width(bvh, 16));
  const auto put = [&](std::size_t at, std::uint32_t value) {
    std::memcpy(file.data() + at, &value, sizeof value);
    forged::sign(std::as_writable_bytes(std::span(file)));
  };
  put(offsetof(FileHeader, version), 2);
  EXPECT_EQ(error_of([&] { forged::load(bytes_of(file)); }).second,
            "the header has something where a zero belongs");
  put(offsetof(FileHeader, node_width), 0);
  const Bvh loaded = forged::load(bytes_of(file));
  const Ray ray{.origin = {0.1f, 0.2f, -3.0f}, .direction = {0, 0, 1}};
  EXPECT_TRUE(loaded.intersect(ray));
  EXPECT_EQ(loaded.intersect(ray), bvh.intersect(ray));
}

// Whatever machine wrote the file: answers do not depend on the tree.
TEST(KerfFile, NodesOfAnotherWidthAreConvertedByLoadAndRefusedByMap) {
  const workbench::Solid torus = workbench::make_torus(48, 24),
                         box = workbench::make_box({-1, -1, -1}, {1, 1, 1}, 4);
  const TriangleMesh meshes[] = {torus.mesh(), box.mesh()};
  const TemporaryDirectory directory;
  const auto file = directory / "scene.kerf";
  std::mt19937 random(3);
  std::vector<Ray> rays(300);
  for (Ray& ray : rays) {
    ray = {.origin = adversarial::uniform_point(random, 2.0f),
           .direction = adversarial::uniform_point(random, 1.0f)};
  }
  kerf_tests::for_each_target([&](const Target&) {
    const Bvh bvh = build(meshes, spatial_splits_everywhere());
    const std::uint32_t own_width = Structure::of(bvh).wide.width;
    for (const std::uint32_t width : {16u, 8u, 4u}) {
      SCOPED_TRACE(width);
      kerf_tests::with_node_width(bvh, width).save(file);
      const Bvh loaded = Bvh::load(file);
      EXPECT_EQ(Structure::of(loaded).wide.width, own_width);
      EXPECT_EQ(loaded.bounds(), bvh.bounds());
      EXPECT_EQ(loaded.statistics().triangles, bvh.statistics().triangles);
      EXPECT_EQ(loaded.statistics().references, bvh.statistics().references);
      for (const Ray& ray : rays) {
        ASSERT_EQ(loaded.intersect(ray), bvh.intersect(ray));
        ASSERT_EQ(loaded.occluded(ray), bvh.occluded(ray));
        ASSERT_EQ(loaded.contains(ray.origin), bvh.contains(ray.origin));
        ASSERT_EQ(loaded.closest_point(ray.origin), bvh.closest_point(ray.origin));
      }
      if (width == own_width) {
        EXPECT_TRUE(Bvh::map(file).intersect({.origin = {0, 0, -3}, .direction = {0, 0, 1}}));
      } else {
        const std::string sentence = error_of([&] { Bvh::map(file); }).second;
        EXPECT_NE(sentence.find("the file has nodes of " + std::to_string(width) + " children"),
                  std::string::npos)
            << sentence;
        EXPECT_NE(sentence.find("load the file instead"), std::string::npos) << sentence;
      }
    }
  });
}

TEST(KerfFile, LinksThatLeadAstrayAreRefused) {
  using Node = WideNode<16>;
  const std::string file = saved(kerf_tests::with_node_width(build(workbench::make_sphere(3).mesh()), 16));
  FileHeader header;
  std::memcpy(&header, file.data(), sizeof header);
  ASSERT_GT(header.nodes, 2u);
  const std::size_t nodes = FileLayout(header).nodes_at;
  const auto forge = [&](std::size_t offset, std::uint32_t value) {
    std::string changed = file;
    std::memcpy(changed.data() + nodes + offset, &value, sizeof value);
    forged::sign(std::as_writable_bytes(std::span(changed)));
    return error_of([&] { forged::load(bytes_of(changed)); }).second;
  };
  const std::size_t first_link = offsetof(Node, children);
  EXPECT_EQ(forge(first_link, ChildLink::node(0).bits()), "a link to an impossible node (0)");
  EXPECT_EQ(forge(first_link, ChildLink::node(header.nodes).bits()), "a link to an impossible node (0)");
  EXPECT_EQ(forge(first_link, ChildLink::leaf(ChildLink::max_place, 8).bits()),
            "a leaf outside the triangles (268435455)");
  EXPECT_EQ(forge(offsetof(Node, order), 0), "a node whose visiting order does not name each child once (0)");
}

// The file is large enough to be read and checked by several threads.
TEST(KerfFile, OfALargeFileTheFirstWrongNodeIsNamedWhicheverThreadFindsOneFirst) {
  using Node = WideNode<16>;
  const Bvh bvh = build(workbench::make_torus(256, 192).mesh());
  const TemporaryDirectory directory;
  bvh.save(directory / "own.kerf");
  EXPECT_EQ(saved(Bvh::load(directory / "own.kerf")), read_bytes(directory / "own.kerf"));
  kerf_tests::with_node_width(bvh, Node::width).save(directory / "large.kerf");
  const std::string file = read_bytes(directory / "large.kerf");
  ASSERT_GT(file.size(), std::size_t{1} << 22);

  FileHeader header;
  std::memcpy(&header, file.data(), sizeof header);
  ASSERT_GT(header.nodes, 1024u);
  std::string changed = file;
  const auto spoil = [&](std::uint32_t node) {
    const std::size_t order = FileLayout(header).nodes_at + node * sizeof(Node) + offsetof(Node, order);
    std::memset(changed.data() + order, 0, sizeof(Node::Order));
    forged::sign(std::as_writable_bytes(std::span(changed)));
    return error_of([&] { forged::load(bytes_of(changed)); }).second;
  };
  for (const std::uint32_t node : {header.nodes - 1, header.nodes / 2, header.nodes / 3}) {
    const std::string sentence = "a node whose visiting order does not name each child once";
    EXPECT_EQ(spoil(node), sentence + " (" + std::to_string(node) + ")");
  }
}

}  // namespace
}  // namespace kerf
